#pragma once
/// Heightfields for the triangulations, and what must hold for any of them, computed another way.

#include <cmath>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <limits>
#include <map>
#include <random>
#include <utility>
#include <vector>

#include "tools/baselines/height_grid.h"

namespace cuesta::test {

using baselines::GridTriangle;
using baselines::HeightGrid;

struct Field {
  std::uint32_t columns = 0, rows = 0;
  std::vector<float> heights_m;
  HeightGrid grid() const { return {columns, rows, heights_m}; }
  float& at(std::uint32_t column, std::uint32_t row) {
    return heights_m[std::size_t{row} * columns + column];
  }
};

inline Field flat(std::uint32_t columns, std::uint32_t rows, float height_m = 0) {
  return {columns, rows, std::vector<float>(std::size_t{columns} * rows, height_m)};
}

/// Waves with noise of whole metres.
inline Field hills(std::uint32_t columns, std::uint32_t rows, unsigned seed) {
  Field field = flat(columns, rows);
  std::mt19937 random(seed);
  for (std::uint32_t r = 0; r < rows; ++r)
    for (std::uint32_t c = 0; c < columns; ++c)
      field.at(c, r) = static_cast<float>(std::lround(100 * std::sin(c * 0.2) * std::cos(r * 0.15)) +
                                          static_cast<int>(random() % 7));
  return field;
}

/// A square of raw little-endian int16.
inline Field load_i16(const std::filesystem::path& path, std::uint32_t side) {
  Field field = flat(side, side);
  std::ifstream file(path, std::ios::binary);
  for (float& h : field.heights_m) {
    unsigned char bytes[2]{};
    file.read(reinterpret_cast<char*>(bytes), 2);
    h = static_cast<std::int16_t>(bytes[0] | bytes[1] << 8);
  }
  return field;
}

/// Largest vertical distance of a posting from the triangles, in barycentric coordinates of f64 over bounding
/// boxes; infinite where a posting is under no triangle.
inline double largest_error(const HeightGrid& grid, const std::vector<GridTriangle>& triangles) {
  const auto column = [&](std::uint32_t p) { return static_cast<double>(p % grid.columns); };
  const auto row = [&](std::uint32_t p) { return static_cast<double>(p / grid.columns); };
  std::vector<double> error(grid.heights_m.size(), std::numeric_limits<double>::infinity());
  for (const auto& [a, b, c] : triangles) {
    const auto [c0, c1] = std::minmax({column(a), column(b), column(c)});
    const auto [r0, r1] = std::minmax({row(a), row(b), row(c)});
    const double area =
        (column(b) - column(a)) * (row(c) - row(a)) - (row(b) - row(a)) * (column(c) - column(a));
    for (double y = r0; y <= r1; ++y)
      for (double x = c0; x <= c1; ++x) {
        const double u = ((column(b) - x) * (row(c) - y) - (row(b) - y) * (column(c) - x)) / area;
        const double v = ((column(c) - x) * (row(a) - y) - (row(c) - y) * (column(a) - x)) / area;
        if (u < 0 || v < 0 || u + v > 1 + 1e-12) continue;
        const double plane = u * grid.heights_m[a] + v * grid.heights_m[b] + (1 - u - v) * grid.heights_m[c];
        const auto p = static_cast<std::size_t>(y) * grid.columns + static_cast<std::size_t>(x);
        error[p] = std::min(error[p], std::abs(grid.heights_m[p] - plane));
      }
  }
  double most = 0;
  for (const double e : error) most = std::max(most, e);
  return most;
}

/// Every edge has two triangles in opposite directions, or lies on the border of the grid; areas are positive
/// seen from above and add up: no T-junction, no overlap.
inline bool is_conforming(const HeightGrid& grid, const std::vector<GridTriangle>& triangles) {
  std::map<std::pair<std::uint32_t, std::uint32_t>, int> edges;
  std::int64_t area = 0;
  const auto column = [&](std::uint32_t p) { return std::int64_t{p % grid.columns}; };
  const auto row = [&](std::uint32_t p) { return std::int64_t{p / grid.columns}; };
  for (const auto& t : triangles) {
    for (std::size_t k = 0; k < 3; ++k) ++edges[{t[k], t[(k + 1) % 3]}];
    const std::int64_t twice = (column(t[2]) - column(t[0])) * (row(t[1]) - row(t[0])) -
                               (column(t[1]) - column(t[0])) * (row(t[2]) - row(t[0]));
    if (twice <= 0) return false;
    area += twice;
  }
  for (const auto& [edge, uses] : edges) {
    const auto [a, b] = edge;
    const bool on_border = (column(a) == column(b) && (column(a) == 0 || column(a) == grid.columns - 1)) ||
                           (row(a) == row(b) && (row(a) == 0 || row(a) == grid.rows - 1));
    if (uses != 1 || edges.contains({b, a}) == on_border) return false;
  }
  return area == 2 * std::int64_t{grid.columns - 1} * (grid.rows - 1);
}

}  // namespace cuesta::test
