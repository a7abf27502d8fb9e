#pragma once
/// A closed surface with detail at several scales, of any size.

#include <cmath>
#include <numbers>

#include "ooc/surface_mesh.h"

namespace cuesta::test {

/// Sphere of radius 1 about (10, 20, 30) with waves; 2·rows·columns - 2·columns triangles, rows ≥ 2.
inline SurfaceMesh bumpy_sphere(std::uint32_t rows, std::uint32_t columns) {
  SurfaceMesh mesh;
  const auto point = [](double theta, double phi) {
    const double r =
        1 + 0.06 * std::sin(7 * theta) * std::cos(5 * phi) + 0.01 * std::sin(31 * theta + 3 * phi);
    return Vec3d{10 + r * std::sin(theta) * std::cos(phi), 20 + r * std::cos(theta),
                 30 - r * std::sin(theta) * std::sin(phi)};
  };
  const auto ring = [&](std::uint32_t row, std::uint32_t column) {
    return 1 + (row - 1) * columns + column % columns;
  };
  mesh.positions.push_back(point(0, 0));
  for (std::uint32_t row = 1; row < rows; ++row)
    for (std::uint32_t column = 0; column < columns; ++column)
      mesh.positions.push_back(point(std::numbers::pi * row / rows, 2 * std::numbers::pi * column / columns));
  mesh.positions.push_back(point(std::numbers::pi, 0));
  const auto last = static_cast<std::uint32_t>(mesh.positions.size() - 1);
  for (std::uint32_t column = 0; column < columns; ++column) {
    mesh.triangles.push_back({0, ring(1, column), ring(1, column + 1)});
    for (std::uint32_t row = 1; row + 1 < rows; ++row) {
      mesh.triangles.push_back({ring(row, column), ring(row + 1, column), ring(row + 1, column + 1)});
      mesh.triangles.push_back({ring(row, column), ring(row + 1, column + 1), ring(row, column + 1)});
    }
    mesh.triangles.push_back({last, ring(rows - 1, column + 1), ring(rows - 1, column)});
  }
  return mesh;
}

}  // namespace cuesta::test
