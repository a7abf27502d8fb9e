#include "tools/baselines/height_grid.h"

#include <algorithm>
#include <cmath>

namespace cuesta::baselines {
namespace {

std::int64_t floor_div(std::int64_t a, std::int64_t b) {  // b > 0
  return a >= 0 ? a / b : -((-a + b - 1) / b);
}

/// The columns of one row that are inside an edge p → q of a triangle with positive turn.
void clip(GridPoint p, GridPoint q, std::int64_t row, std::int64_t& first, std::int64_t& last) {
  const std::int64_t rise = q.row - p.row;
  // inside: (q.column - p.column)(row - p.row) + rise · p.column ≥ rise · column
  const std::int64_t limit = std::int64_t{q.column - p.column} * (row - p.row) + rise * p.column;
  if (rise > 0) last = std::min(last, floor_div(limit, rise));
  if (rise < 0) first = std::max(first, -floor_div(limit, -rise));
}

}  // namespace

WorstPosting worst_posting(const HeightGrid& grid, GridPoint a, GridPoint b, GridPoint c) {
  const auto height = [&](GridPoint p) {
    return double{grid.at(static_cast<std::uint32_t>(p.column), static_cast<std::uint32_t>(p.row))};
  };
  const double ha = height(a), hb = height(b), hc = height(c);
  const auto area = static_cast<double>(turn(a, b, c));
  // The plane's height times the area, and what it gains with each column.
  const double gain = ha * (b.row - c.row) + hb * (c.row - a.row) + hc * (a.row - b.row);
  WorstPosting worst{0, a};
  double most = 0;  // error · area
  const std::int64_t last_row = std::max({a.row, b.row, c.row});
  for (std::int64_t row = std::min({a.row, b.row, c.row}); row <= last_row; ++row) {
    std::int64_t first = 0, last = grid.columns - 1;
    clip(a, b, row, first, last);
    clip(b, c, row, first, last);
    clip(c, a, row, first, last);
    const GridPoint start{static_cast<std::int32_t>(first), static_cast<std::int32_t>(row)};
    double plane = ha * static_cast<double>(turn(b, c, start)) + hb * static_cast<double>(turn(c, a, start)) +
                   hc * static_cast<double>(turn(a, b, start));
    const float* heights = grid.heights_m.data() + row * grid.columns;
    for (std::int64_t column = first; column <= last; ++column, plane += gain) {
      const double off = std::abs(heights[column] * area - plane);
      if (off <= most) continue;
      most = off;
      worst.at = {static_cast<std::int32_t>(column), static_cast<std::int32_t>(row)};
    }
  }
  worst.error_m = most / area;
  return worst;
}

}  // namespace cuesta::baselines
