#include "runtime/instance_culling.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "ooc/affine.h"

namespace cuesta {

Ball ball_of(const Affine& world, const Box3d& box) {
  if (box.empty()) return {world.translation, 0};
  const Vec3d half = (box.hi - box.lo) * 0.5;
  double longest = 0;  // of the four diagonals
  for (const auto& [y, z] :
       {std::array{1., 1.}, std::array{-1., 1.}, std::array{1., -1.}, std::array{-1., -1.}})
    longest = std::max(longest, length(world.vector({half.x, y * half.y, z * half.z})));
  return {world.point((box.lo + box.hi) * 0.5), longest};
}

ViewCone::ViewCone(const View& view)
    : eye_(view.eye),
      frame_(view.frame()),
      pixels_per_unit_(view.pixels_per_unit()),
      half_width_(view.width_px * 0.5),
      half_height_(view.height_px * 0.5) {
  const double tan_y = half_height_ / pixels_per_unit_, tan_x = half_width_ / pixels_per_unit_;
  const auto& [right, up, back] = frame_;
  sides_ = {normalized(right - back * tan_x), normalized(-right - back * tan_x),
            normalized(up - back * tan_y), normalized(-up - back * tan_y)};
}

bool ViewCone::may_see(const Ball& ball) const {
  const Vec3d d = ball.centre - eye_;
  if (dot(d, frame_[2]) > ball.radius) return false;
  return std::all_of(sides_.begin(), sides_.end(), [&](Vec3d n) { return dot(d, n) >= -ball.radius; });
}

ViewCone::Footprint ViewCone::footprint(const Ball& ball) const {
  const Vec3d d = ball.centre - eye_;
  const double depth = -dot(d, frame_[2]);
  if (depth <= ball.radius) return {1, 0, std::numeric_limits<double>::infinity()};
  const double scale = pixels_per_unit_ / depth, x = dot(d, frame_[0]) * scale, y = dot(d, frame_[1]) * scale;
  const double r = pixels_per_unit_ * ball.radius / std::sqrt(depth * depth - ball.radius * ball.radius);
  const auto inside = [r](double at, double half) {
    return std::max(0.0, std::min(at + r, half) - std::max(at - r, -half));
  };
  const double covered = inside(x, half_width_) * inside(y, half_height_);
  return {covered / (4 * half_width_ * half_height_),
          std::max(0.0, std::hypot(x, y) - r) / std::hypot(half_width_, half_height_), 2 * r};
}

}  // namespace cuesta
