#include "runtime/view_fit.h"

#include <algorithm>
#include <cmath>

namespace cuesta {
namespace {

constexpr double margin = 1.04;  // of the distance

}  // namespace

double fit_distance(const Box3d& box, Vec3d towards_eye, const View& view) {
  View probe = view;
  probe.target = (box.lo + box.hi) * 0.5;
  probe.eye = probe.target + normalized(towards_eye);
  const auto [right, up, back] = probe.frame();
  const double tan_y = std::tan(view.fov_y_rad / 2);
  const double tan_x = tan_y * view.width_px / view.height_px;
  const Vec3d half = (box.hi - box.lo) * 0.5;
  double distance = 0;
  for (int corner = 0; corner < 8; ++corner) {
    const Vec3d c{corner & 1 ? half.x : -half.x, corner & 2 ? half.y : -half.y,
                  corner & 4 ? half.z : -half.z};
    const double aside = std::max(std::abs(dot(c, right)) / tan_x, std::abs(dot(c, up)) / tan_y);
    distance = std::max(distance, dot(c, back) + aside);
  }
  // A single point has no size: any distance shows it.
  return distance > 0 ? distance : 1;
}

View fit_view(const Box3d& box, Vec3d towards_eye, View view) {
  const double distance = fit_distance(box, towards_eye, view) * margin;
  view.target = (box.lo + box.hi) * 0.5;
  view.eye = view.target + normalized(towards_eye) * distance;
  return view;
}

Vec3d front_direction(Vec3d up) {
  const Vec3d above = normalized(up);
  const Vec3d a{std::abs(up.x), std::abs(up.y), std::abs(up.z)};
  const Vec3d front = a.z > a.x && a.z > a.y ? Vec3d{0, -1, 0} : Vec3d{0, 0, 1};
  return normalized(front - above * dot(front, above));
}

Vec3d three_quarter_direction(Vec3d up) {
  const Vec3d above = normalized(up);
  const Vec3d front = front_direction(up);
  return normalized(front + cross(above, front) * 0.55 + above * 0.35);
}

}  // namespace cuesta
