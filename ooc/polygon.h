#pragma once
/// Polygons of any shape into triangles.

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "ooc/vec.h"

namespace cuesta {

/// Keeps its scratch memory between polygons: one object per thread.
class PolygonTriangulator {
 public:
  static constexpr std::size_t bytes_per_corner = 32 + 4 + 12;  ///< of the largest polygon so far

  /// Triangulates one polygon, concave or not, by clipping ears in its best-fit plane (Newell's normal).
  /// @param corners  in order, three or more; the last joins the first.
  /// @return corners.size() - 2 triples of corner numbers, wound as the polygon; valid until the next call.
  ///         A polygon without area, with a coordinate that is not finite, or that crosses itself so that no
  ///         ear is left, ends as a fan of what remains.
  /// @cost O(n) for convex polygons, O(n · reflex corners) usually; at most 1024·n point tests, then a fan.
  std::span<const std::array<std::uint32_t, 3>> triangulate(std::span<const Vec3d> corners);

 private:
  struct Corner {
    double x, y;  ///< in the plane, where the polygon is counter-clockwise
    std::uint32_t next, previous;
    bool reflex;
  };
  bool project(std::span<const Vec3d> corners);
  void clip_ears();
  bool is_ear(std::uint32_t i);
  void update_reflex(std::uint32_t i);
  void fan_rest(std::uint32_t first, std::uint32_t left);

  std::vector<Corner> ring_;
  std::vector<std::uint32_t>
      reflex_;  ///< corners that were reflex at the start, less those clipped or now convex
  std::vector<std::array<std::uint32_t, 3>> triangles_;
  std::uint64_t tests_left_ = 0;
};

}  // namespace cuesta
