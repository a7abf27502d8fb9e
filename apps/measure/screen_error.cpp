#include "apps/measure/screen_error.h"

#include <cmath>
#include <vector>

#include "apps/measure/surface_distance.h"
#include "ooc/check.h"

namespace cuesta::measure {
namespace {

/// The half-spaces of a picture, ready for many points.
struct Frustum {
  explicit Frustum(const View& view)
      : axes(view.frame()),
        eye(view.eye),
        tan_y(std::tan(view.fov_y_rad / 2)),
        tan_x(tan_y * view.width_px / view.height_px) {}

  bool contains(Vec3d p) const {
    const Vec3d d = p - eye;
    const double depth = -dot(d, axes[2]);
    return depth > 0 && std::abs(dot(d, axes[0])) <= depth * tan_x &&
           std::abs(dot(d, axes[1])) <= depth * tan_y;
  }

  std::array<Vec3d, 3> axes;
  Vec3d eye;
  double tan_y, tan_x;
};

double error_px(double k, double deviation, double distance) {
  return deviation == 0 ? 0 : k * deviation / distance;
}

}  // namespace

bool in_frustum(const View& view, Vec3d p) {
  return Frustum(view).contains(p);
}

ScreenError screen_error(std::span<const Vec3d> original, std::span<const double> distances, const View& view,
                         Region region) {
  CUESTA_CHECK(original.size() == distances.size(), original.size(), distances.size());
  const Frustum frustum(view);
  const double k = view.pixels_per_unit();
  ScreenError result;
  std::vector<double> errors;
  double worst = -1;
  for (std::size_t v = 0; v < original.size(); ++v) {
    if (std::isnan(distances[v]) || (region == Region::in_frustum && !frustum.contains(original[v])))
      continue;
    errors.push_back(error_px(k, distances[v], length(original[v] - view.eye)));
    if (errors.back() <= worst) continue;
    worst = errors.back();
    result.worst = static_cast<std::uint32_t>(v);
  }
  result.px = percentiles(std::move(errors));
  return result;
}

ScreenError screen_error(std::span<const Vec3d> original, const TriangleTree& simplified, const View& view,
                         Region region) {
  if (region == Region::everywhere) {
    return screen_error(original, point_distances(original, simplified), view, region);
  }
  const Frustum frustum(view);
  std::vector<Vec3d> seen;
  std::vector<std::uint32_t> number;
  for (std::uint32_t v = 0; v < original.size(); ++v) {
    if (!frustum.contains(original[v])) continue;
    seen.push_back(original[v]);
    number.push_back(v);
  }
  ScreenError result = screen_error(seen, point_distances(seen, simplified), view, Region::everywhere);
  if (!number.empty()) result.worst = number[result.worst];
  return result;
}

}  // namespace cuesta::measure
