#include "tools/baselines/right_triangles.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>

#include "ooc/check.h"

namespace cuesta::baselines {
namespace {

GridPoint middle(GridPoint a, GridPoint b) {
  return {(a.column + b.column) / 2, (a.row + b.row) / 2};
}

/// The shortest hypotenuse has no posting in its middle: such triangles are exact.
bool can_split(GridPoint a, GridPoint b) {
  return (a.column + b.column) % 2 == 0 && (a.row + b.row) % 2 == 0;
}

/// The smallest f32 that is not less: what is stored must bound.
float rounded_up(double x) {
  const auto near = static_cast<float>(x);
  return near >= x ? near : std::nextafter(near, std::numeric_limits<float>::infinity());
}

}  // namespace

bool RightTriangles::takes(std::uint32_t columns, std::uint32_t rows) {
  return columns == rows && columns >= 2 && columns <= most_columns_or_rows &&
         std::has_single_bit(columns - 1);
}

RightTriangles::RightTriangles(const HeightGrid& grid) : grid_(grid), error_m_(grid.heights_m.size()) {
  CUESTA_CHECK(takes(grid.columns, grid.rows), grid.columns, grid.rows);
  CUESTA_CHECK(grid.heights_m.size() == std::size_t{grid.columns} * grid.rows, grid.heights_m.size());
  const auto last = static_cast<std::int32_t>(grid.columns) - 1;
  const int levels = 2 * std::countr_zero(grid.columns - 1);
  // Level by level from below: a midpoint is shared by two triangles, and both must be done before it is
  // used.
  for (int level = levels - 1; level >= 0; --level) {
    saturate({0, 0}, {last, last}, {last, 0}, level);
    saturate({last, last}, {0, 0}, {0, last}, level);
  }
}

std::uint32_t RightTriangles::posting(GridPoint p) const {
  return static_cast<std::uint32_t>(p.row) * grid_.columns + static_cast<std::uint32_t>(p.column);
}

/// Of the triangles `level` splits below a, b, c, whose hypotenuse is ab.
void RightTriangles::saturate(GridPoint a, GridPoint b, GridPoint c, int level) {
  const GridPoint m = middle(a, b);
  if (level > 0) {
    saturate(c, a, m, level - 1);
    saturate(b, c, m, level - 1);
    return;
  }
  float error = rounded_up(worst_posting(grid_, a, c, b).error_m);
  if (can_split(a, c))
    error = std::max({error, error_m_[posting(middle(a, c))], error_m_[posting(middle(b, c))]});
  float& stored = error_m_[posting(m)];
  stored = std::max(stored, error);
}

void RightTriangles::refine(GridPoint a, GridPoint b, GridPoint c, double most_error_m,
                            std::vector<GridTriangle>& out) const {
  const GridPoint m = middle(a, b);
  if (can_split(a, b) && error_m_[posting(m)] > most_error_m) {
    refine(c, a, m, most_error_m, out);
    refine(b, c, m, most_error_m, out);
  } else {
    out.push_back({posting(a), posting(b), posting(c)});
  }
}

std::vector<GridTriangle> RightTriangles::cut(double most_error_m) const {
  const auto last = static_cast<std::int32_t>(grid_.columns) - 1;
  std::vector<GridTriangle> out;
  refine({0, 0}, {last, last}, {last, 0}, most_error_m, out);
  refine({last, last}, {0, 0}, {0, last}, most_error_m, out);
  return out;
}

}  // namespace cuesta::baselines
