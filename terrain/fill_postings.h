#pragma once
/// Postings without data, interpolated between data on both sides.

#include <cstdint>
#include <span>

namespace cuesta {

/// What a field has around the window that is filled.
struct FieldBorder {
  std::uint64_t west = 0, east = 0, north = 0, south = 0;  ///< postings
};

/// A posting without data that has some within `reach` on both sides along its row, or its column, becomes
/// the mean of the nearest data on those sides, weighted by 1 / distance; along one line that is linear
/// interpolation. Nothing farther than `reach` matters, so windows with a border of it agree.
/// @param field  width · height, row by row, NaN where there is no data.
/// @param inner  the field without its border; its NaNs are set. @return how many.
/// @cost  O(width · height); 16 bytes a column.
std::uint64_t fill_postings(std::span<const double> field, std::uint64_t width, std::uint64_t height,
                            const FieldBorder& border, std::uint32_t reach, std::span<double> inner);

}  // namespace cuesta
