#pragma once
/// Cuts the triangles of a round into cells of equal count. Each round cuts along other directions, so that
/// the borders of one round are interior to the cells of the next: no border keeps its resolution for two
/// rounds.

#include <cstdint>
#include <span>
#include <vector>

#include "ooc/space_tree.h"
#include "ooc/vec.h"

namespace cuesta {

/// Cell c holds triangles order[begin[c]] … order[begin[c + 1] - 1], ascending within a cell.
struct Partition {
  std::vector<std::uint32_t> order;
  std::vector<std::uint32_t> begin;

  std::uint32_t cell_count() const { return static_cast<std::uint32_t>(begin.size() - 1); }
  std::span<const std::uint32_t> cell(std::uint32_t c) const {
    return {order.data() + begin[c], begin[c + 1] - begin[c]};
  }
};

/// The directions that a round cuts along: far from those of the rounds before and after.
Axes axes_of(std::uint32_t round);

/// Balanced kd-cuts of triangle centres across the longest extent, along axes_of(round).
/// @param centres        one per triangle, any unit
/// @param cell_triangles largest cell; cells differ by at most one triangle
/// @cost  O(n log(cells)), deterministic.
Partition partition_cells(std::span<const Vec3f> centres, std::uint32_t cell_triangles, std::uint32_t round);

}  // namespace cuesta
