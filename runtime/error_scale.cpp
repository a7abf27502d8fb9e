#include "runtime/error_scale.h"

#include <cmath>
#include <numbers>

namespace cuesta {

ErrorScale ErrorScale::uniform(const Grid& grid) {
  ErrorScale s;
  s.unit_ = 1 / grid.step;
  return s;
}

ErrorScale ErrorScale::perspective(const Grid& grid, const View& view, double outside_factor, double margin) {
  ErrorScale s;
  s.uniform_ = false;
  s.unit_ = 1 / view.pixels_per_unit();
  s.outside_factor_ = outside_factor;
  s.eye_ = (view.eye - grid.origin) / grid.step;
  const auto [right, up, back] = view.frame();
  const Vec3d ahead = -back;
  const double half_y = view.fov_y_rad / 2;
  const double half_x = std::atan(std::tan(half_y) * view.width_px / view.height_px);
  const double limit = std::numbers::pi / 2 - 1e-3;
  const double x = std::min(half_x * (1 + margin), limit);
  const double y = std::min(half_y * (1 + margin), limit);
  s.planes_ = {ahead * std::sin(x) + right * std::cos(x), ahead * std::sin(x) - right * std::cos(x),
               ahead * std::sin(y) + up * std::cos(y), ahead * std::sin(y) - up * std::cos(y), ahead};
  return s;
}

bool ErrorScale::outside(Vec3d to_centre, double radius) const {
  for (const Vec3d& n : planes_)
    if (dot(n, to_centre) < -radius) return true;
  return false;
}

double ErrorScale::scale(const Sphere& s) const {
  if (uniform_) return unit_;
  const Vec3d to_centre = vec_cast<double>(s.centre) - eye_;
  const double near = length(to_centre) - static_cast<double>(s.radius);
  if (near <= 0) return 0;
  const double scale = near * unit_;
  return outside_factor_ > 1 && outside(to_centre, s.radius) ? scale * outside_factor_ : scale;
}

}  // namespace cuesta
