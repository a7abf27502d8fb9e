#pragma once
/// Hand-made surfaces for tests.

#include <array>
#include <cstdint>
#include <initializer_list>
#include <vector>

#include "ooc/surface_mesh.h"

namespace cuesta::test {

using Triangles = std::vector<std::array<std::uint32_t, 3>>;

inline SurfaceMesh mesh_of(std::vector<Vec3d> positions, Triangles triangles) {
  SurfaceMesh mesh;
  mesh.positions = std::move(positions);
  mesh.triangles = std::move(triangles);
  return mesh;
}

/// Vertices (0,0,0) (1,0,0) (0,1,0) (0,0,1), outside counter-clockwise.
inline SurfaceMesh tetrahedron() {
  return mesh_of({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}}, {{0, 2, 1}, {0, 1, 3}, {0, 3, 2}, {1, 2, 3}});
}

/// Unit cube at `at`; vertex x + 2y + 4z is its corner (x, y, z). Two triangles per face, in the order -x +x
/// -y +y -z +z.
inline SurfaceMesh cube(Vec3d at = {}) {
  SurfaceMesh mesh;
  for (int i = 0; i < 8; ++i)
    mesh.positions.push_back(at + Vec3d{double(i & 1), double(i >> 1 & 1), double(i >> 2)});
  const std::uint32_t quads[6][4] = {{0, 4, 6, 2}, {1, 3, 7, 5}, {0, 1, 5, 4},
                                     {2, 6, 7, 3}, {0, 2, 3, 1}, {4, 5, 7, 6}};
  for (const auto& q : quads) {
    mesh.triangles.push_back({q[0], q[1], q[2]});
    mesh.triangles.push_back({q[0], q[2], q[3]});
  }
  return mesh;
}

/// Three vertices of its own per triangle, as an STL file has. With `normals`, the triangle's.
inline SurfaceMesh soup_of(const SurfaceMesh& mesh, bool normals = false) {
  SurfaceMesh soup;
  for (const auto& t : mesh.triangles) {
    const auto n = static_cast<std::uint32_t>(soup.positions.size());
    soup.triangles.push_back({n, n + 1, n + 2});
    const Vec3d a = mesh.positions[t[0]], b = mesh.positions[t[1]], c = mesh.positions[t[2]];
    soup.positions.insert(soup.positions.end(), {a, b, c});
    if (normals) soup.normals.resize(n + 3, vec_cast<float>(normalized(cross(b - a, c - a))));
  }
  return soup;
}

/// Both meshes side by side, vertices not shared. Positions and triangles only.
inline SurfaceMesh joined(SurfaceMesh a, const SurfaceMesh& b) {
  const auto n = static_cast<std::uint32_t>(a.positions.size());
  a.positions.insert(a.positions.end(), b.positions.begin(), b.positions.end());
  for (const auto& t : b.triangles) a.triangles.push_back({t[0] + n, t[1] + n, t[2] + n});
  return a;
}

/// An open cone of `n` ≥ 3 triangles with its apex at the origin and its rim at height `z`, seen from
/// outside.
inline SurfaceMesh cone(int n, double z) {
  SurfaceMesh mesh;
  mesh.positions.push_back({0, 0, 0});
  for (int i = 0; i < n; ++i) {
    const double angle = 6.283185307179586 * i / n;
    mesh.positions.push_back({std::cos(angle), std::sin(angle), z});
    const auto a = static_cast<std::uint32_t>(i + 1), b = static_cast<std::uint32_t>((i + 1) % n + 1);
    mesh.triangles.push_back(z < 0 ? std::array{0u, a, b} : std::array{0u, b, a});
  }
  return mesh;
}

/// `n` × `n` quads over [0, n]², gently waved so that no four points are in one plane.
inline SurfaceMesh wavy_patch(int n) {
  SurfaceMesh mesh;
  for (int y = 0; y <= n; ++y)
    for (int x = 0; x <= n; ++x)
      mesh.positions.push_back({double(x), double(y), std::sin(0.1 * x) * std::cos(0.13 * y) * 5});
  for (int y = 0; y < n; ++y)
    for (int x = 0; x < n; ++x) {
      const auto a = static_cast<std::uint32_t>(y * (n + 1) + x), b = a + 1;
      const auto c = a + static_cast<std::uint32_t>(n + 1), d = c + 1;
      mesh.triangles.push_back({a, b, d});
      mesh.triangles.push_back({a, d, c});
    }
  return mesh;
}

}  // namespace cuesta::test
