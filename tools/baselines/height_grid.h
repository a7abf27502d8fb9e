#pragma once
/// What the triangulations of heightfields work on, and the error that they bound.

#include <array>
#include <cstdint>
#include <span>
#include <vector>

namespace cuesta::baselines {

/// Postings are numbered row by row, posting (column, row) is row · columns + column; row 0 is the
/// northernmost.
struct HeightGrid {
  std::uint32_t columns = 0, rows = 0;
  std::span<const float> heights_m;  ///< columns · rows, all finite

  float at(std::uint32_t column, std::uint32_t row) const {
    return heights_m[std::size_t{row} * columns + column];
  }
};

/// Postings of the corners, counter-clockwise seen from above.
using GridTriangle = std::array<std::uint32_t, 3>;

struct GridPoint {
  std::int32_t column = 0, row = 0;
  friend bool operator==(GridPoint, GridPoint) = default;
};

/// Larger sides would overflow the exact predicates: an in-circle determinant of side s is below 6 s^4.
inline constexpr std::uint32_t most_columns_or_rows = (1u << 14) + 1;

/// The posting farthest above or below a triangle's plane.
struct WorstPosting {
  double error_m = 0;  ///< vertical, 0 when there is no posting but the corners
  GridPoint at;
};

/// Twice the signed area; positive when a, b, c turn from the columns' axis to the rows' axis, which is
/// clockwise seen from above.
constexpr std::int64_t turn(GridPoint a, GridPoint b, GridPoint c) {
  return std::int64_t{b.column - a.column} * (c.row - a.row) -
         std::int64_t{b.row - a.row} * (c.column - a.column);
}

/// Over all postings in the triangle, its edges included; the first in reading order among equals. For
/// heights of at most 24 bits above the point and sides up to 2^14 the numerators are exact.
/// @pre turn(a, b, c) > 0.   @cost about 2 ns per posting and 20 ns per row.
WorstPosting worst_posting(const HeightGrid& grid, GridPoint a, GridPoint b, GridPoint c);

}  // namespace cuesta::baselines
