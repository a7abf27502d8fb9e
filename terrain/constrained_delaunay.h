#pragma once
/// Triangles between points of a plane, among whose edges are given segments.
///
/// Source: Lawson, "Software for C1 surface interpolation", 1977 (insertion and flips); Sloan, "A fast
/// algorithm for generating constrained Delaunay triangulations", 1993 (segments by flips). Deviation:
/// circles are compared in f64 with an error bound, and what is too close to call stays, so triangles are
/// Delaunay within rounding; orientations are exact, so the triangulation is one whatever the points.

#include <array>
#include <cstdint>
#include <span>
#include <vector>

namespace cuesta {

/// Whole coordinates, x to the right and y up, each within ±2^48.
struct GridPoint {
  std::int64_t x = 0, y = 0;
  bool operator==(const GridPoint&) const = default;
};

struct DelaunayTriangle {
  static constexpr std::uint32_t none = ~std::uint32_t{0};
  std::array<std::uint32_t, 3> points = {};  ///< counter-clockwise
  std::array<std::uint32_t, 3> across = {};  ///< triangle beyond the edge opposite of each point, or none
  std::array<bool, 3> is_segment = {};       ///< whether that edge is one of the segments
};

struct Triangulation {
  std::vector<DelaunayTriangle> triangles;
  std::uint64_t lost_segments =
      0;  ///< that cross others or touch points between their ends: they are left out
};

/// @param segments  pairs of indices of points. @pre no two points are equal.
/// @return triangles over the points' convex hull, but for flat ones along its rim, of less than 1/100 of its
/// area.
/// @cost  O(n √n) for n points that are spread out, near to O(n) along lines; 100 bytes a point.
Triangulation triangulate(std::span<const GridPoint> points,
                          std::span<const std::array<std::uint32_t, 2>> segments);

}  // namespace cuesta
