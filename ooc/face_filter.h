#pragma once
/// Drops the faces that no surface can have: degenerate ones and copies of another face.

#include <cstdint>
#include <span>
#include <vector>

#include "ooc/triangle_order.h"

namespace cuesta {

struct FacesDropped {
  std::uint64_t degenerate = 0;  ///< two corners in one wedge group
  std::uint64_t duplicate = 0;   ///< the same three groups as an earlier face, either way round
};

/// Drops in place; what is left is rotated smallest index first and stably sorted by the group of that
/// vertex.
/// @param group  per vertex: the first vertex of its wedge group; groups are consecutive vertices.
/// @cost O(n log n) at worst, linear while few faces start at one group.
FacesDropped drop_impossible_faces(std::vector<Triangle>& triangles, std::span<const std::uint32_t> group);

}  // namespace cuesta
