#pragma once
/// Makes one vertex of those at one grid point with equal attributes, in order along the curve.

#include <cstdint>
#include <span>
#include <vector>

#include "ooc/vertex_table.h"

namespace cuesta {

/// Vertices of one grid point are consecutive, in ascending order of `source`: a wedge group.
struct Welded {
  std::vector<std::uint32_t> source;  ///< per welded vertex: the first input vertex that it stands for
  std::vector<std::uint32_t> group;   ///< per welded vertex: the first welded vertex at its grid point
  std::vector<std::uint32_t> of;      ///< per input vertex: its welded vertex
};

/// @pre coordinates in [0, 2^30).
/// @cost O(n log n) at worst, linear while few vertices share a position; 32 bytes per vertex.
Welded weld(const VertexTable& vertices);

}  // namespace cuesta
