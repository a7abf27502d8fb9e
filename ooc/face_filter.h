#pragma once
/// Finds the faces that no surface can have: degenerate ones and copies of another face.

#include <cstdint>
#include <span>
#include <vector>

#include "ooc/triangle_order.h"

namespace cuesta {

enum class FaceFault : std::uint8_t {
  none,
  degenerate,  ///< two corners in one wedge group
  duplicate,   ///< the same three groups as an earlier face, either way round
};

/// @param group  per vertex: the first vertex of its wedge group; groups are consecutive vertices.
/// @return one per triangle.
/// @cost O(n log n) at worst, linear while few faces start at one group.
std::vector<FaceFault> face_faults(std::span<const Triangle> triangles, std::span<const std::uint32_t> group);

}  // namespace cuesta
