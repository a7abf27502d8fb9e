#include "runtime/visual_error.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace cuesta {
namespace {

constexpr double right_angle = std::numbers::pi / 2;
constexpr double factor_step = 1.25;
constexpr float rounding_rad = 1e-3f;  // of f32 normals and arc cosines near 1

/// Least |cosine| between a direction of one cone and one of the other.
double least_cosine(Vec3d axis, double angle, Vec3d direction, double spread) {
  const double between = std::acos(std::clamp(dot(axis, direction), -1.0, 1.0));
  const double most = std::min(between, std::numbers::pi - between) + angle + spread;
  return most < right_angle ? std::cos(most) : 0;
}

}  // namespace

NormalCone NormalCone::around(std::span<const Vec3f> unit_normals) {
  Vec3d sum{};
  for (const Vec3f& n : unit_normals) sum = sum + vec_cast<double>(n);
  NormalCone cone;
  if (!(length(sum) > 0)) return cone;
  cone.axis = vec_cast<float>(normalized(sum));
  float least = 1;
  for (const Vec3f& n : unit_normals) least = std::min(least, dot(cone.axis, n));
  cone.angle_rad = std::acos(std::max(least, -1.0f)) + rounding_rad;
  return cone;
}

double VisualError::page_factor(const NormalCone& normals, const Sphere& bound, Vec3d eye) const {
  const Vec3d axis = vec_cast<double>(normals.axis);
  const Vec3d to_eye = eye - vec_cast<double>(bound.centre);
  const double distance = length(to_eye);
  const double radius = bound.radius;
  if (!(distance > radius)) return 1;
  double facing = least_cosine(axis, normals.angle_rad, to_eye / distance, std::asin(radius / distance));
  if (light) facing *= least_cosine(axis, normals.angle_rad, normalized(*light), 0);
  const double factor = 1 + (facing_factor - 1) * facing;
  return std::pow(factor_step, std::floor(std::log(factor) / std::log(factor_step)));
}

}  // namespace cuesta
