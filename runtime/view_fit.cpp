#include "runtime/view_fit.h"

#include <algorithm>
#include <cmath>

#include "ooc/check.h"

namespace cuesta {
namespace {

constexpr double margin = 1.08;  // of the distance

std::array<Vec3d, 3> frame_towards(Vec3d towards_eye, View view) {
  view.target = {};
  view.eye = normalized(towards_eye);
  return view.frame();
}

std::array<double, 2> tangents(const View& view) {
  const double tan_y = std::tan(view.fov_y_rad / 2);
  return {tan_y * view.width_px / view.height_px, tan_y};
}

}  // namespace

Box3d box_of(std::span<const Vec3d> points) {
  Box3d box;
  for (const Vec3d& p : points) box.add(p);
  return box;
}

View fit_view(std::span<const Vec3d> points, Vec3d towards_eye, View view) {
  CUESTA_CHECK(!points.empty());
  const auto [right, up, back] = frame_towards(towards_eye, view);
  const auto [tan_x, tan_y] = tangents(view);
  const Box3d box = box_of(points);
  const Vec3d centre = (box.lo + box.hi) * 0.5;
  // A point (x, y, z) about the centre is inside the right side of an eye at (ex, ey, ez) if x + tan·z ≤ ex +
  // tan·ez.
  double right_most = -1e300, left_most = -1e300, top = -1e300, bottom = -1e300;
  for (const Vec3d& p : points) {
    const double x = dot(p - centre, right), y = dot(p - centre, up), z = dot(p - centre, back);
    right_most = std::max(right_most, x + tan_x * z);
    left_most = std::max(left_most, -x + tan_x * z);
    top = std::max(top, y + tan_y * z);
    bottom = std::max(bottom, -y + tan_y * z);
  }
  double distance = std::max((right_most + left_most) / (2 * tan_x), (top + bottom) / (2 * tan_y));
  if (!(distance > 0)) distance = 1;  // one point has no size: any distance shows it
  const Vec3d aside = right * ((right_most - left_most) / 2) + up * ((top - bottom) / 2);
  view.target = centre + aside;
  view.eye = view.target + back * (distance * margin);
  return view;
}

double fit_distance(std::span<const Vec3d> points, Vec3d centre, Vec3d towards_eye, const View& view) {
  const auto [right, up, back] = frame_towards(towards_eye, view);
  const auto [tan_x, tan_y] = tangents(view);
  double distance = 0;
  for (const Vec3d& p : points) {
    const Vec3d d = p - centre;
    const double aside = std::max(std::abs(dot(d, right)) / tan_x, std::abs(dot(d, up)) / tan_y);
    distance = std::max(distance, dot(d, back) + aside);
  }
  return distance > 0 ? distance * margin : 1;
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
