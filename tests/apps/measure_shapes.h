#pragma once
/// Meshes whose distances are known, and random ones.

#include <numbers>
#include <random>

#include "ooc/surface_mesh.h"

namespace cuesta::test {

/// n × n squares on [0, 1]² at height z, two triangles each.
inline SurfaceMesh square(std::uint32_t n, double z) {
  SurfaceMesh mesh;
  for (std::uint32_t y = 0; y <= n; ++y) {
    for (std::uint32_t x = 0; x <= n; ++x) mesh.positions.push_back({double(x) / n, double(y) / n, z});
  }
  for (std::uint32_t y = 0; y < n; ++y) {
    for (std::uint32_t x = 0; x < n; ++x) {
      const std::uint32_t a = y * (n + 1) + x, b = a + 1, c = a + n + 1, d = c + 1;
      mesh.triangles.push_back({a, b, d});
      mesh.triangles.push_back({a, d, c});
    }
  }
  return mesh;
}

/// Latitude–longitude sphere about the origin; the rows at the poles are degenerate triangles, on purpose.
inline SurfaceMesh sphere(std::uint32_t rings, double radius) {
  SurfaceMesh mesh = square(rings, 0);
  for (Vec3d& p : mesh.positions) {
    const double longitude = 2 * std::numbers::pi * p.x, polar = std::numbers::pi * p.y;
    p = Vec3d{std::sin(polar) * std::cos(longitude), std::sin(polar) * std::sin(longitude),
              -std::cos(polar)} *
        radius;
  }
  return mesh;
}

/// Triangles of very different sizes and shapes, one in eight degenerate, about a far centre.
inline SurfaceMesh random_soup(std::uint32_t seed, std::uint32_t triangles, Vec3d centre = {}) {
  std::mt19937 bits(seed);
  std::uniform_real_distribution<double> unit(-1, 1);
  const auto point = [&] { return Vec3d{unit(bits), unit(bits), unit(bits)}; };
  SurfaceMesh mesh;
  for (std::uint32_t i = 0; i < triangles; ++i) {
    const Vec3d a = centre + point();
    const Vec3d u = point() * std::pow(10.0, 2 * unit(bits) - 2), v = i % 8 ? point() * 0.1 : u * unit(bits);
    for (const Vec3d& p : {a, a + u, a + v}) mesh.positions.push_back(p);
    mesh.triangles.push_back({3 * i, 3 * i + 1, 3 * i + 2});
  }
  return mesh;
}

}  // namespace cuesta::test
