#include "apps/view/surface_ray.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "apps/view/ray.h"

namespace cuesta::view {
namespace {

/// What is drawn, in grid units, with its heights as they are drawn.
class DrawnSurface {
 public:
  DrawnSurface(const DrawList& list, const Directory& directory, const std::optional<Relief>& relief)
      : list_(list), directory_(directory) {
    if (relief && relief->exaggeration != 1) relief_ = relief->in(list.grid);
  }

  /// Where ranges may be met, nearest first.
  struct Stop {
    double distance;
    std::size_t draw;
  };
  std::vector<Stop> stops(const Ray& ray) const {
    const bool pages_known = list_.draw_pages.size() == list_.draws.size();
    std::vector<Stop> all;
    for (std::size_t i = 0; i < list_.draws.size(); ++i) {
      const double at = pages_known ? distance(ray, directory_.pages[list_.draw_pages[i]].bound) : 0;
      if (std::isfinite(at)) all.push_back({at, i});
    }
    std::sort(all.begin(), all.end(), [](const Stop& a, const Stop& b) { return a.distance < b.distance; });
    return all;
  }

  double distance(const Ray& ray, std::size_t draw) const {
    const auto corners = list_.indices.subspan(list_.draws[draw].first, list_.draws[draw].count);
    double nearest = std::numeric_limits<double>::infinity();
    for (std::size_t k = 0; k + 2 < corners.size(); k += 3)
      nearest = std::min(
          nearest, ray.distance(position(corners[k]), position(corners[k + 1]), position(corners[k + 2])));
    return nearest;
  }

 private:
  double distance(const Ray& ray, const Sphere& bound) const {
    constexpr double curve_stretch = 1.01;  // as of ErrorScale
    const Vec3d centre = vec_cast<double>(bound.centre);
    const double radius = bound.radius;
    if (!relief_) return ray.distance(centre, radius);
    return ray.distance(relief_->raised(centre),
                        radius * std::max(1.0, relief_->exaggeration) * curve_stretch);
  }
  Vec3d position(std::uint32_t slot) const {
    const DrawVertex& v = list_.vertices[slot];
    const Vec3d p{static_cast<double>(v.x), static_cast<double>(v.y), static_cast<double>(v.z)};
    return relief_ ? relief_->raised(p) : p;
  }

  const DrawList& list_;
  const Directory& directory_;
  std::optional<Relief> relief_;  // grid units
};

}  // namespace

std::optional<double> distance_along(const DrawList& list, const Directory& directory, Vec3d origin,
                                     Vec3d direction, const std::optional<Relief>& relief) {
  const Ray ray{(origin - list.grid.origin) / list.grid.step, direction};
  const DrawnSurface surface(list, directory, relief);
  double nearest = std::numeric_limits<double>::infinity();
  for (const auto& [distance, draw] : surface.stops(ray)) {
    if (distance > nearest) break;
    nearest = std::min(nearest, surface.distance(ray, draw));
  }
  if (!std::isfinite(nearest)) return {};
  return nearest * list.grid.step;
}

}  // namespace cuesta::view
