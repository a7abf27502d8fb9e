#include "runtime/view.h"

#include <cmath>

namespace cuesta {

double View::pixels_per_unit() const {
  return height_px / (2 * std::tan(fov_y_rad / 2));
}

std::array<Vec3d, 3> View::frame() const {
  const Vec3d back = normalized(eye - target);
  Vec3d right = cross(up, back);
  if (dot(right, right) < 1e-24) right = cross(Vec3d{back.y, back.z, back.x}, back);
  right = normalized(right);
  return {right, cross(back, right), back};
}

}  // namespace cuesta
