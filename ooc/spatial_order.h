#pragma once
/// Order of grid positions along the Morton curve: near in the order is near in space, mostly.

#include <cstdint>
#include <vector>

#include "ooc/vec.h"

namespace cuesta {

/// Bits per axis that fit in one 64-bit key.
inline constexpr int kMortonBits = 21;

/// Interleaves the low 21 bits of x, y, z, x lowest.   @pre coordinates ≥ 0
std::uint64_t morton_key(Vec3i g);

/// A point's key with the point's number. 16 bytes.
struct CurveEntry {
  std::uint64_t key;
  std::uint32_t index;
};

/// Stable sort by key: radix, 11 bits a pass, passes in which all keys agree left out.
/// @cost O(n) with at most 6 passes; a second array of the same size.
void sort_by_key(std::vector<CurveEntry>& entries);

}  // namespace cuesta
