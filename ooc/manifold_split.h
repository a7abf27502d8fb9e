#pragma once
/// Separates the sheets that meet in a point: each wedge group becomes one copy per fan of triangles around
/// it, so that every group is a disc or half-disc. Two groups may then share a position: they are different
/// sheets.

#include <cstdint>
#include <span>
#include <vector>

#include "ooc/triangle_order.h"

namespace cuesta {

/// The vertices after the split: old order, unused ones left out, a group's copies behind it in the order in
/// which `triangles` first reach them.
struct SplitVertices {
  std::vector<std::uint32_t> source;  ///< per new vertex: the old vertex with its position and attributes
  std::vector<std::uint32_t> group;   ///< per new vertex: the first new vertex of its group
  std::uint64_t used_before = 0;      ///< whole old vertices that a triangle uses
  std::uint64_t copies = 0;           ///< whole new vertices beyond those
};

/// Renumbers `triangles` to the new vertices.
/// @param group  per old vertex: the first vertex of its wedge group; groups are consecutive vertices.
/// @param whole  per old vertex, the same in a group: whether all triangles around it are here. The others
///               are left as they are, one group each.
/// @param twins  from edge_twins: triangles are connected where they are twins and nowhere else.
/// @post  Each edge of the new groups has one triangle, or two that run along it in opposite directions. (A
/// cut edge
///        whose triangles stay in one fan at both ends has exactly the first and the last of that fan: it
///        closes.)
/// @cost  linear in triangles, O(c log c) in copies; 3 bytes per triangle and 9 per vertex beside the result.
SplitVertices split_fans(std::vector<Triangle>& triangles, std::span<const std::uint32_t> group,
                         std::span<const std::uint8_t> whole, std::span<const std::uint32_t> twins);

}  // namespace cuesta
