#pragma once
/// Which vertices at one position are one point of the surface. A file does not store wedge groups; edges
/// tell.

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "ooc/vec.h"

namespace cuesta {

/// Two triangles that run along one edge (by position) in opposite directions, the only two there, are
/// neighbours: their vertices at its ends are one point, also where attributes differ. Sheets that merely
/// touch stay apart.
/// @param positions  one per vertex
/// @return per vertex the lowest vertex of its point.   @cost O(n log n), 40 bytes per triangle for a while.
std::vector<std::uint32_t> seam_groups(std::span<const Vec3i> positions,
                                       std::span<const std::array<std::uint32_t, 3>> triangles);

}  // namespace cuesta
