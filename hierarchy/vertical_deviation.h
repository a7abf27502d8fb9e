#pragma once
/// Vertical distances of many points from a triangle, which triangle of several a point's vertical goes
/// through, and the point of a rim that is beside one.

#include <array>
#include <cstdint>

#include "hierarchy/local_vertical.h"
#include "ooc/vec.h"

namespace cuesta {

/// Points in structure-of-arrays form, `count` of them; arrays are as long as a multiple of 8.
struct VerticalPoints {
  std::size_t count = 0;
  const float *x = nullptr, *y = nullptr, *z = nullptr;
  const float *up_x = nullptr, *up_y = nullptr, *up_z = nullptr;  ///< not read on a plane
  /// So far the most that a vertical is inside a triangle, seen from above, in grid units: the least distance
  /// from its edges, < 0 beyond one.
  float* inside = nullptr;
  float* squared = nullptr;         ///< squared vertical distance from that triangle
  std::int32_t* nearest = nullptr;  ///< its index
};

/// A triangle as verticals see it.
struct UprightTriangle {
  std::array<Vec3f, 3> corners;
  Vec3f normal;           ///< unit, from f64
  float twice_area = 0;   ///< 0 for one without an inside
  float uprightness = 0;  ///< the least cosine between the normal and up at a corner
  float longest_squared = 0;
};
UprightTriangle upright(const std::array<Vec3f, 3>& corners, const LocalVertical& vertical);

/// Largest cosine that says "seen from its edge": such a triangle has neither an above nor a below.
inline constexpr float least_uprightness = 1.0f / 256;
/// A point this little outside counts as inside, in grid units: what rounding may do to `inside`.
inline constexpr float inside_rounding = -1.0f / 16;

/// Points whose verticals go through the triangle more inwards than through those before take `index`.
void measure_vertical(const UprightTriangle& triangle, const LocalVertical& vertical, std::int32_t index,
                      const VerticalPoints& points);

/// A point that is less than this far inside its triangle may be on a rim, in grid units.
inline constexpr float rim_width = 1;

/// How far p is inside of the edge from a to b of a triangle, seen from above along the unit vector `up`; < 0
/// beyond it.
inline double inside_of(Vec3d p, Vec3d a, Vec3d b, Vec3d up) {
  const double along = length(cross(up, b - a));
  return along > 0 ? dot(up, cross(b - a, p - a)) / along : length(cross(up, p - a));
}

/// The point of a triangle's outline that is nearest to a vertical.
struct BesidePoint {
  double off = 0;               ///< distance from the vertical
  double squared_distance = 0;  ///< from the point on it
};
BesidePoint beside(const std::array<Vec3f, 3>& corners, Vec3f p, const LocalVertical& vertical);

}  // namespace cuesta
