#pragma once
/// Makes one vertex of those that snap to one grid point with bit-identical attributes, in order along the
/// curve.

#include <cstdint>
#include <span>
#include <vector>

#include "ooc/grid.h"
#include "ooc/surface_mesh.h"

namespace cuesta {

/// Vertices of one grid point are consecutive, in ascending order of `source`: a wedge group.
struct Welded {
  std::vector<std::uint32_t> source;  ///< per welded vertex: the first input vertex that it stands for
  std::vector<std::uint32_t> group;   ///< per welded vertex: the first welded vertex at its grid point
  std::vector<std::uint32_t> of;      ///< per input vertex: its welded vertex; kNone if not used
};

/// Welds the vertices with `used[v] != 0`.
/// @pre used.size() == positions.size(); used vertices snap to coordinates in [0, 2^30).
/// @cost O(n log n) at worst, linear while few vertices share a position; 32 bytes per used vertex.
Welded weld(const SurfaceMesh& mesh, const Grid& grid, std::span<const std::uint8_t> used);

}  // namespace cuesta
