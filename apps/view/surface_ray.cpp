#include "apps/view/surface_ray.h"

#include <cmath>

namespace cuesta::view {
namespace {

struct Ray {
  Vec3d origin, direction;  // grid units

  bool may_meet(const Sphere& s) const {
    const Vec3d to = vec_cast<double>(s.centre) - origin;
    const double ahead = dot(to, direction), radius = static_cast<double>(s.radius);
    if (ahead < -radius) return false;
    return dot(to, to) - ahead * ahead <= radius * radius * (1 + 1e-6);
  }
  /// Distance to a triangle; infinity without.   Source: Möller, Trumbore, "Fast, Minimum Storage
  /// Ray/Triangle Intersection", JGT 1997.
  double distance(Vec3d a, Vec3d b, Vec3d c) const {
    constexpr double none = std::numeric_limits<double>::infinity();
    const Vec3d ab = b - a, ac = c - a, p = cross(direction, ac);
    const double determinant = dot(ab, p);
    if (determinant == 0) return none;
    const Vec3d to = origin - a;
    const double u = dot(to, p) / determinant;
    if (!(u >= 0 && u <= 1)) return none;
    const Vec3d q = cross(to, ab);
    const double v = dot(direction, q) / determinant;
    if (!(v >= 0 && u + v <= 1)) return none;
    const double t = dot(ac, q) / determinant;
    return t > 0 ? t : none;
  }
};

Vec3d position(const DrawList& list, std::uint32_t slot) {
  const DrawVertex& v = list.vertices[slot];
  return {static_cast<double>(v.x), static_cast<double>(v.y), static_cast<double>(v.z)};
}

}  // namespace

std::optional<double> distance_along(const DrawList& list, const Directory& directory, Vec3d origin,
                                     Vec3d direction) {
  const Ray ray{(origin - list.grid.origin) / list.grid.step, direction};
  const bool pages_known = list.draw_pages.size() == list.draws.size();
  double nearest = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < list.draws.size(); ++i) {
    if (pages_known && !ray.may_meet(directory.pages[list.draw_pages[i]].bound)) continue;
    const auto corners = list.indices.subspan(list.draws[i].first, list.draws[i].count);
    for (std::size_t k = 0; k + 2 < corners.size(); k += 3)
      nearest = std::min(nearest, ray.distance(position(list, corners[k]), position(list, corners[k + 1]),
                                               position(list, corners[k + 2])));
  }
  if (!std::isfinite(nearest)) return {};
  return nearest * list.grid.step;
}

}  // namespace cuesta::view
