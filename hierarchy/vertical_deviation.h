#pragma once
/// Vertical distances of many points from a triangle, and which triangle of several a point's vertical goes
/// through.

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
  float* inside = nullptr;  ///< so far the largest of the smallest barycentric coordinates: ≥ 0 in a triangle
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
/// A point this little outside counts as inside: what rounding may do to barycentric coordinates.
inline constexpr float inside_rounding = -1e-4f;

/// Points whose verticals go through the triangle more inwards than through those before take `index`.
void measure_vertical(const UprightTriangle& triangle, const LocalVertical& vertical, std::int32_t index,
                      const VerticalPoints& points);

}  // namespace cuesta
