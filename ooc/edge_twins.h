#pragma once
/// Which half-edges face each other: the adjacency of an indexed surface, taken wedge group by wedge group.

#include <cstdint>
#include <span>
#include <vector>

#include "ooc/triangle_order.h"

namespace cuesta {

/// @return per half-edge (3 per triangle) the opposite one, or kNone at a border and at a cut edge: one that
/// has more
///         than two triangles, or two that run along it in the same direction.
/// @param group        per vertex: the first vertex of its wedge group
/// @param counted      per vertex: whether cut edges are counted whose lower group starts there
/// @param edges_cut    incremented per counted cut edge
/// @pre   no triangle has two corners in one group; triangles.size() ≤ kMaxTriangles.
/// @cost  linear while degrees are small (a sort per vertex); 24 bytes per triangle beside the result's 12.
std::vector<std::uint32_t> edge_twins(std::span<const Triangle> triangles,
                                      std::span<const std::uint32_t> group,
                                      std::span<const std::uint8_t> counted, std::uint64_t& edges_cut);

}  // namespace cuesta
