#include "apps/view/scene.h"

#include <algorithm>

#include "apps/view/budget_shares.h"
#include "apps/view/surface_ray.h"
#include "runtime/view_fit.h"

namespace cuesta::view {

void Scene::add(std::string name, std::unique_ptr<Cut> cut, std::vector<Vec3d> points) {
  const Box3d box = box_of(points);
  const Vec3d centre = (box.lo + box.hi) * 0.5;
  objects_.push_back({std::move(name), std::move(cut), std::move(points), centre, length(box.hi - box.lo) / 2,
                      AdaptReport{}});
}

bool Scene::adapt(const View& view, const Options& options) {
  relief_ = options.relief;
  if (objects_.empty()) return false;
  std::vector<double> weights;
  for (const Object& o : objects_) weights.push_back(visible_weight(view, o.centre, o.radius));
  const auto shares = share_budgets(options.budgets, weights);
  const bool grown = lists_.size() != objects_.size();
  bool changed = grown;
  lists_.clear();
  for (std::size_t i = 0; i < objects_.size(); ++i) {
    Object& o = objects_[i];
    const Grid& grid = o.cut->directory().grid;
    auto scale = ErrorScale::perspective(grid, view, options.outside_factor);
    if (options.relief) scale = scale.exaggerated(grid, *options.relief);
    o.cut->set_tagging(options.tags);
    o.cut->set_geomorph_ms(options.geomorph_ms);
    o.report = o.cut->adapt(scale, options.tau_px, shares[i]);
    lists_.push_back(options.only_visible ? o.cut->draw_list(scale) : o.cut->draw_list());
    changed = changed || !lists_.back().morphed.empty() || !lists_.back().changed_vertices.empty() ||
              !lists_.back().changed_indices.empty() ||
              o.report.coarse_operations + o.report.fine_operations > 0;
  }
  return changed;
}

void Scene::list_all() {
  for (std::size_t i = 0; i < lists_.size(); ++i) lists_[i] = objects_[i].cut->draw_list();
}

void Scene::mark_drawn() {
  for (DrawList& list : lists_) list.changed_vertices = list.changed_indices = {};
}

AdaptReport Scene::report() const {
  AdaptReport sum;
  sum.settled = true;
  for (const Object& o : objects_) {
    sum.add_work_of(o.report);
    sum.triangles += o.report.triangles;
    sum.resident_bytes += o.report.resident_bytes;
    sum.pages_missing += o.report.pages_missing;
    sum.morphing += o.report.morphing;
    sum.tau = std::max(sum.tau, o.report.tau);
    sum.achieved = std::max(sum.achieved, o.report.achieved);
    sum.settled = sum.settled && o.report.settled;
    if (sum.bound_by == Binding::nothing) sum.bound_by = o.report.bound_by;
  }
  return sum;
}

std::uint64_t Scene::resident_pages() const {
  std::uint64_t pages = 0;
  for (const Object& o : objects_) pages += o.cut->cache().resident_ids().size();
  return pages;
}

std::uint64_t Scene::cache_bytes() const {
  std::uint64_t bytes = 0;
  for (const Object& o : objects_) bytes += o.cut->cache().budget_bytes();
  return bytes;
}

std::uint64_t Scene::unreadable_pages() const {
  std::uint64_t pages = 0;
  for (const Object& o : objects_) pages += o.cut->cache().errors().size();
  return pages;
}

std::vector<Vec3d> Scene::points() const {
  std::vector<Vec3d> all;
  for (const Object& o : objects_) all.insert(all.end(), o.points.begin(), o.points.end());
  return all;
}

double Scene::diagonal() const {
  Box3d box;
  for (const Object& o : objects_) box.add(box_of(o.points));
  return box.empty() ? 1 : length(box.hi - box.lo);
}

std::optional<Vec3d> Scene::hit(Vec3d origin, Vec3d direction) const {
  std::optional<double> nearest;
  for (std::size_t i = 0; i < lists_.size(); ++i) {
    const auto distance = distance_along(lists_[i], objects_[i].cut->directory(), origin, direction, relief_);
    if (distance && (!nearest || *distance < *nearest)) nearest = distance;
  }
  if (!nearest) return {};
  return origin + direction * *nearest;
}

}  // namespace cuesta::view
