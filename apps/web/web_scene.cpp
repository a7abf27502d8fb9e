#include "apps/web/web_scene.h"

#include <algorithm>
#include <nlohmann/json.hpp>

#include "apps/web/words.h"
#include "runtime/draw/tom_vertices.h"
#include "runtime/scene_sources.h"
#include "runtime/view_fit.h"

namespace cuesta::web {
namespace {

using nlohmann::json;

json list(Vec3d v) {
  return {v.x, v.y, v.z};
}

/// A frame costs what it has of triangles and nothing else, so a deadline is a budget of them.
constexpr double triangle_ms = 1e-3;

std::vector<MeasuredFrame> triangles_alone() {
  std::vector<MeasuredFrame> frames;
  for (std::uint32_t i = 0; i < 32; ++i) {
    const auto pick = [i](std::uint32_t bit, double few, double many) { return i >> bit & 1 ? many : few; };
    const FrameWork work{pick(0, 10, 1000), pick(1, 1e4, 1e6), pick(2, 1e5, 1e8), pick(3, 1e5, 1e7),
                         pick(4, 0, 1e5)};
    frames.push_back({work, work.triangles * triangle_ms});
  }
  return frames;
}

std::optional<std::uint32_t> first_surface(const SceneFile& file) {
  for (std::uint32_t i = 0; i < file.parts().size(); ++i)
    if (!file.parts()[i].is_tom()) return i;
  return std::nullopt;
}

/// Distance along a ray to a triangle. Source: Möller, Trumbore, "Fast, Minimum Storage Ray/Triangle
/// Intersection", 1997.
std::optional<double> hit(Vec3d origin, Vec3d direction, Vec3d a, Vec3d b, Vec3d c) {
  const Vec3d e = b - a, f = c - a, p = cross(direction, f);
  const double det = dot(e, p);
  if (det == 0) return std::nullopt;
  const Vec3d s = origin - a, q = cross(s, e);
  const double u = dot(s, p) / det, v = dot(direction, q) / det, t = dot(f, q) / det;
  if (u < 0 || v < 0 || u + v > 1 || !(t > 0)) return std::nullopt;
  return t;
}

/// True if a line may meet the box's ball.
bool may_meet(Vec3d origin, Vec3d direction, const Box3d& box) {
  const Vec3d to = (box.lo + box.hi) * 0.5 - origin;
  const double along = dot(to, direction), radius = length(box.hi - box.lo) / 2;
  return dot(to, to) - along * along <= radius * radius * (1 + 1e-9);
}

Box3d box_of(const Tom& tom) {
  Box3d box;
  if (tom.positions.empty()) return box;
  box.add(tom.origin + vec_cast<double>(tom.bounds.lo));
  box.add(tom.origin + vec_cast<double>(tom.bounds.hi));
  return box;
}

}  // namespace

Result<std::optional<ByteRange>> WebScene::open(std::uint64_t cache_bytes) {
  auto file = SceneFile::open(bytes_);
  if (!file && bytes_->missing()) return bytes_->missing();
  if (!file) return fail(file.error());
  if (const auto part = first_surface(*file))
    return fail(ErrorCode::invalid_input, bytes_->path().string(), "part " + std::to_string(*part),
                "it is a surface of its own, of " + std::to_string(file->parts()[*part].triangles) +
                    " triangles; the browser shows scenes whose parts are all TOMs: build it with a larger "
                    "--largest-tom");
  bytes_->forget();
  file_ = std::make_unique<SceneFile>(std::move(*file));
  SceneSources sources = sources_of(*file_, clock_, 0);
  sources.tom = [this, read = std::move(sources.tom)](std::uint32_t part, const Tom* have,
                                                      std::uint32_t have_segments, std::uint32_t segments) {
    auto tom = read(part, have, have_segments, segments);
    for (std::uint32_t s = have_segments; s < segments; ++s)
      bytes_->forget(file_->parts()[part].segments[s].block.offset);
    return tom;
  };
  sources.tom_at_hand = [this](std::uint32_t part, std::uint32_t have_segments, std::uint32_t segments) {
    bool all = true;
    for (std::uint32_t s = have_segments; s < segments; ++s) all &= at_hand(part, s);
    return all;
  };
  SceneSettings settings;
  settings.cache_bytes = cache_bytes / 2;
  settings.index_bytes = cache_bytes / 2;
  settings.load_threads = 0;
  auto scene = LiveScene::open(file_->directory(), std::move(sources), settings, clock_);
  if (!scene) return fail(scene.error());
  scene_ = std::move(*scene);
  scene_->calibrate(triangles_alone());
  return std::optional<ByteRange>();
}

bool WebScene::at_hand(std::uint32_t part, std::uint32_t segment) {
  const BlockRef& block = file_->parts()[part].segments[segment].block;
  if (bytes_->has({block.offset, block.bytes}) || given_up_.contains(block.offset)) return true;
  if (!asked_offsets_.insert(block.offset).second) return false;
  waiting_[next_id_] = block;
  asked_.push_back({next_id_++, block});
  return false;
}

std::vector<WebScene::Asked> WebScene::take_asked() {
  const auto end = asked_.begin() + static_cast<std::ptrdiff_t>(std::min(asked_.size(), most_asked));
  const std::vector<Asked> taken(asked_.begin(), end);
  asked_.erase(asked_.begin(), end);
  return taken;
}

bool WebScene::bring(std::uint32_t id, std::vector<std::byte> stored) {
  const auto at = waiting_.find(id);
  if (at == waiting_.end()) return false;
  if (stored.size() != at->second.bytes) return give_up(id);
  asked_offsets_.erase(at->second.offset);
  bytes_->deliver(at->second.offset, std::move(stored));
  waiting_.erase(at);
  return true;
}

bool WebScene::give_up(std::uint32_t id) {
  const auto at = waiting_.find(id);
  if (at == waiting_.end()) return false;
  given_up_.insert(at->second.offset);
  asked_offsets_.erase(at->second.offset);
  waiting_.erase(at);
  return true;
}

std::string WebScene::facts() const {
  std::uint64_t vertices = 0, triangles = 0;
  for (const SceneInstance& in : file_->instances()) {
    vertices += file_->parts()[in.part].vertices;
    triangles += file_->parts()[in.part].triangles;
  }
  Box3d box = scene_->bounds();
  if (box.empty()) box = {{0, 0, 0}, {1, 1, 1}};
  const json facts{{"vertices", vertices},
                   {"triangles", triangles},
                   {"bytes", bytes_->size()},
                   {"box", {list(box.lo), list(box.hi)}},
                   {"grid", {{"origin", list(box.lo)}, {"step", 1}}},
                   {"normals", true},
                   {"colours", true},
                   {"rounds", json::array()},
                   {"scene", {{"parts", file_->parts().size()}, {"instances", file_->instances().size()}}}};
  return facts.dump();
}

View WebScene::first_view(const View& view) const {
  return fit_view(scene_->corners(), three_quarter_direction(view.up), view);
}

WebScene::Step WebScene::step(const Aim& aim) {
  SceneFrameOptions options;
  options.tau_px = std::max(aim.tau_px, 1e-3);
  options.deadline_ms = std::max(1.0, static_cast<double>(aim.budgets.triangles) * triangle_ms);
  ++step_;
  Step step;
  step.report = scene_->frame(aim.view, options);
  step.failed = static_cast<std::uint32_t>(scene_->store().errors().size());
  step.settled =
      step.report.store.missing <= step.report.store.waiting_for_budget && step.report.store.loaded == 0;
  drawn_ = scene_->list();
  tell(drawn_);
  step.words = words_;
  return step;
}

void WebScene::tell(const SceneDrawList& list) {
  std::vector<const DrawnGroup*> parts, blocks;
  const auto is_new = [this](auto& told, std::uint32_t id, const auto& what) {
    Told& t = told[id];
    t.used = step_;
    if (t.what.lock() == what) return false;
    t.what = what;
    return true;
  };
  for (const DrawnGroup& g : list.groups) {
    if (is_new(told_parts_, g.part, g.tom)) parts.push_back(&g);
    if (is_new(told_blocks_, static_cast<std::uint32_t>(g.indices->id), g.indices)) blocks.push_back(&g);
  }
  const auto forget = [this](auto& told) {
    std::vector<std::uint32_t> forgotten;
    std::erase_if(told, [&](const auto& entry) {
      const bool old = entry.second.used + kept_steps < step_;
      if (old) forgotten.push_back(entry.first);
      return old;
    });
    return forgotten;
  };
  const std::vector<std::uint32_t> old_parts = forget(told_parts_), old_blocks = forget(told_blocks_);

  Words out(words_);
  for (const std::size_t n : {parts.size(), blocks.size(), old_parts.size(), old_blocks.size(),
                              list.groups.size(), list.instances.size(), std::size_t{0}, std::size_t{0}})
    out.put(n);
  for (const DrawnGroup& g : list.groups) {
    const std::array<double, 4> grid{g.tom->origin.x, g.tom->origin.y, g.tom->origin.z, g.tom->step};
    out.put_elements(std::span<const double>(grid));
  }
  for (const DrawnInstance& in : list.instances) {
    const auto& c = in.world.columns;
    const Vec3d t = in.world.translation;
    const std::array<double, 12> map{c[0].x, c[0].y, c[0].z, c[1].x, c[1].y, c[1].z,
                                     c[2].x, c[2].y, c[2].z, t.x,    t.y,    t.z};
    out.put_elements(std::span<const double>(map));
  }
  for (const DrawnInstance& in : list.instances) out.put_elements(std::span<const Rgba8>(&in.colour, 1));
  for (const DrawnGroup& g : list.groups)
    for (const std::size_t n : {std::size_t{g.part}, static_cast<std::size_t>(g.indices->id),
                                std::size_t{g.first}, std::size_t{g.count}, std::size_t{g.mirrored}})
      out.put(n);
  std::vector<DrawVertex> vertices;
  for (const DrawnGroup* g : parts) {
    vertices.clear();
    for (std::size_t v = 0; v < g->tom->positions.size(); ++v) vertices.push_back(vertex_of(*g->tom, v));
    out.put(g->part), out.put(vertices.size());
    out.put_elements(std::span<const DrawVertex>(vertices));
  }
  for (const DrawnGroup* g : blocks) {
    out.put(static_cast<std::size_t>(g->indices->id)), out.put(g->indices->triangles.size());
    out.put_elements(std::span<const Triangle>(g->indices->triangles));
  }
  out.put_elements(std::span<const std::uint32_t>(old_parts));
  out.put_elements(std::span<const std::uint32_t>(old_blocks));
}

std::optional<double> WebScene::distance_along(Vec3d origin, Vec3d direction) const {
  std::optional<double> nearest;
  for (const DrawnGroup& g : drawn_.groups)
    for (const DrawnInstance& in : drawn_.instances.subspan(g.first, g.count)) {
      if (!may_meet(origin, direction, map_box(in.world, box_of(*g.tom)))) continue;
      const auto corner = [&](std::uint32_t v) {
        return in.world.point(g.tom->origin + vec_cast<double>(g.tom->positions[v]));
      };
      for (const Triangle& t : g.indices->triangles) {
        const auto at = hit(origin, direction, corner(t[0]), corner(t[1]), corner(t[2]));
        if (at && (!nearest || *at < *nearest)) nearest = at;
      }
    }
  return nearest;
}

std::string WebScene::first_error() const {
  const auto errors = scene_->store().errors();
  return errors.empty() ? "" : errors.front().text();
}

}  // namespace cuesta::web
