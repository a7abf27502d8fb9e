#pragma once
/// Which pieces of a pool to upload: what changed, in few pieces.

#include <cstdint>
#include <span>
#include <vector>

#include "runtime/draw_list.h"

namespace cuesta {

/// Ranges that contain all of `changed` and, between two that are near each other, what lies between:
/// ascending, disjoint, none empty. A call to the driver costs as much as copying some thousand bytes, so
/// small gaps are filled; they grow until at most `most` ranges are left.
/// @param changed  in any order, may overlap.   @param gap  elements, > 0.   @param most  > 0.
/// @cost  O(n log n).
std::vector<Range> coalesce(std::span<const Range> changed, std::uint32_t gap, std::size_t most);

}  // namespace cuesta
