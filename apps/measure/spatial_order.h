#pragma once
/// An order of points in which neighbours follow each other, so that one nearest-point query can help the
/// next.

#include <cstdint>
#include <span>
#include <vector>

#include "ooc/vec.h"

namespace cuesta::measure {

/// Indices of the finite points along a Morton curve of 2^21 cells per axis; ties by index.
/// @cost O(n log n), 16 bytes per point for a while.
std::vector<std::uint32_t> spatial_order(std::span<const Vec3d> points);

}  // namespace cuesta::measure
