#pragma once
/// Which way is up on a surface that is a field of heights. What goes through a point upwards is its
/// vertical: the normal of an ellipsoid, or one direction everywhere.

#include "ooc/vec.h"

namespace cuesta {

/// In any one unit of length; vertex positions are in grid units.
struct Vertical {
  Vec3d axis{0, 0, 1};  ///< unit: up on a plane, the polar axis of an ellipsoid
  bool is_plane = true;
  Vec3d centre{};      ///< of the ellipsoid; of no meaning on a plane, as the following
  double stretch = 0;  ///< a² / b² - 1 of its half axes

  /// Points up at p; on an ellipsoid about as long as its radius, and the geodetic normal of p to within 5
  /// µrad up to 10 km above it.
  Vec3d direction(Vec3d p) const {
    if (is_plane) return axis;
    const Vec3d q = p - centre;
    return q + axis * (stretch * dot(q, axis));
  }
};

}  // namespace cuesta
