#pragma once
/// A ray, and how far along it lies what it meets. Lengths are in units of its direction.

#include <algorithm>
#include <cmath>
#include <limits>

#include "ooc/vec.h"

namespace cuesta::view {

struct Ray {
  Vec3d origin, direction;  ///< not zero

  /// How far the ray goes before it may meet a ball; infinity if it does not.   @pre direction is unit
  double distance(Vec3d centre, double radius) const {
    constexpr double none = std::numeric_limits<double>::infinity();
    const Vec3d to = centre - origin;
    const double ahead = dot(to, direction);
    if (ahead < -radius) return none;
    const bool meets = dot(to, to) - ahead * ahead <= radius * radius * (1 + 1e-6);
    return meets ? std::max(ahead - radius, 0.0) : none;
  }
  /// To a triangle, from either side; infinity without.   Source: Möller, Trumbore, "Fast, Minimum Storage
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

}  // namespace cuesta::view
