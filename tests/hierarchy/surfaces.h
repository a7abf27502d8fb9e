#pragma once
/// Generated surfaces with known topology: closed, with a handle, open, in pieces, with attribute seams.

#include <cmath>
#include <map>
#include <utility>

#include "tests/ooc/small_meshes.h"

namespace cuesta::test {

inline double bumps(Vec3d p) {
  return 0.06 * std::sin(5 * p.x + 1) * std::cos(4 * p.y) +
         0.02 * std::sin(17 * p.z + 9 * p.x) * std::cos(13 * p.y);
}

/// Octahedron with each edge cut `n` times, on a unit sphere with bumps: 8 n² triangles, closed, V - E + F
/// = 2.
inline SurfaceMesh bumpy_sphere(int n, Vec3d at = {}, double size = 1) {
  SurfaceMesh mesh;
  std::map<std::array<int, 3>, std::uint32_t> known;
  const auto vertex = [&](std::array<int, 3> g) {
    const auto [it, fresh] = known.try_emplace(g, static_cast<std::uint32_t>(mesh.positions.size()));
    if (fresh) {
      const Vec3d p = normalized(Vec3d{double(g[0]), double(g[1]), double(g[2])});
      mesh.positions.push_back(at + p * (size * (1 + bumps(p))));
    }
    return it->second;
  };
  for (int octant = 0; octant < 8; ++octant) {
    const int sx = octant & 1 ? -1 : 1, sy = octant & 2 ? -1 : 1, sz = octant & 4 ? -1 : 1;
    const auto corner = [&](int i, int j) { return vertex({sx * i, sy * j, sz * (n - i - j)}); };
    const auto add = [&](std::uint32_t a, std::uint32_t b, std::uint32_t c) {
      sx* sy* sz > 0 ? mesh.triangles.push_back({a, b, c}) : mesh.triangles.push_back({a, c, b});
    };
    for (int i = 0; i < n; ++i)
      for (int j = 0; i + j < n; ++j) {
        add(corner(i, j), corner(i + 1, j), corner(i, j + 1));
        if (i + j + 1 < n) add(corner(i + 1, j), corner(i + 1, j + 1), corner(i, j + 1));
      }
  }
  return mesh;
}

/// 2 n m triangles around a ring, closed, V - E + F = 0.
inline SurfaceMesh bumpy_torus(int n, int m) {
  SurfaceMesh mesh;
  for (int i = 0; i < n; ++i)
    for (int j = 0; j < m; ++j) {
      const double a = 2 * M_PI * i / n, b = 2 * M_PI * j / m;
      const Vec3d unit{std::cos(a) * std::cos(b), std::sin(a) * std::cos(b), std::sin(b)};
      const double r = 0.35 + 0.5 * bumps(unit);
      mesh.positions.push_back(
          {(1 + r * std::cos(b)) * std::cos(a), (1 + r * std::cos(b)) * std::sin(a), r * std::sin(b)});
    }
  const auto at = [&](int i, int j) { return static_cast<std::uint32_t>((i % n) * m + j % m); };
  for (int i = 0; i < n; ++i)
    for (int j = 0; j < m; ++j) {
      mesh.triangles.push_back({at(i, j), at(i + 1, j), at(i + 1, j + 1)});
      mesh.triangles.push_back({at(i, j), at(i + 1, j + 1), at(i, j + 1)});
    }
  return mesh;
}

/// A cube of 6 n² quads whose faces have vertices and normals of their own: seams along its twelve edges.
inline SurfaceMesh faceted_cube(int n) {
  SurfaceMesh mesh;
  for (int face = 0; face < 6; ++face) {
    const int axis = face / 2, u = (axis + 1) % 3, v = (axis + 2) % 3;
    const double side = face % 2 ? 1 : -1;
    const auto first = static_cast<std::uint32_t>(mesh.positions.size());
    for (int i = 0; i <= n; ++i)
      for (int j = 0; j <= n; ++j) {
        Vec3d p;
        p[axis] = side;
        p[u] = 2.0 * i / n - 1;
        p[v] = 2.0 * j / n - 1;
        Vec3f normal;
        normal[axis] = static_cast<float>(side);
        mesh.positions.push_back(p * (1 + 0.3 * bumps(p)));
        mesh.normals.push_back(normal);
      }
    const auto at = [&](int i, int j) { return first + static_cast<std::uint32_t>(i * (n + 1) + j); };
    for (int i = 0; i < n; ++i)
      for (int j = 0; j < n; ++j) {
        std::array<std::uint32_t, 3> a{at(i, j), at(i + 1, j), at(i + 1, j + 1)},
            b{at(i, j), at(i + 1, j + 1), at(i, j + 1)};
        if (side < 0) std::swap(a[1], a[2]), std::swap(b[1], b[2]);
        mesh.triangles.insert(mesh.triangles.end(), {a, b});
      }
  }
  return mesh;
}

/// A vase of n × m quads: closed around by a seam of texture coordinates, open at both ends.
inline SurfaceMesh seamed_vase(int n, int m) {
  SurfaceMesh mesh;
  for (int i = 0; i <= n; ++i)
    for (int j = 0; j <= m; ++j) {
      const double a = 2 * M_PI * (i % n) / n, z = 3.0 * j / m;
      const double r = 0.6 + 0.2 * std::sin(3 * z) + 0.1 * bumps({std::cos(a), std::sin(a), z});
      mesh.positions.push_back({r * std::cos(a), r * std::sin(a), z});
      mesh.texcoords.push_back({static_cast<float>(i) / static_cast<float>(n), static_cast<float>(z)});
    }
  const auto at = [&](int i, int j) { return static_cast<std::uint32_t>(i * (m + 1) + j); };
  for (int i = 0; i < n; ++i)
    for (int j = 0; j < m; ++j) {
      mesh.triangles.push_back({at(i, j), at(i + 1, j), at(i + 1, j + 1)});
      mesh.triangles.push_back({at(i, j), at(i + 1, j + 1), at(i, j + 1)});
    }
  return mesh;
}

/// Spheres of several sizes side by side; the small ones are tiny against the errors of coarse cuts.
inline SurfaceMesh pebbles() {
  SurfaceMesh mesh = bumpy_sphere(16);
  for (int i = 0; i < 30; ++i)
    mesh = joined(std::move(mesh),
                  bumpy_sphere(2 + i % 4, {1.5 + 0.3 * (i % 6), 0.3 * (i / 6), 0.1 * (i % 3)}, 0.1));
  return mesh;
}

struct NamedSurface {
  const char* name;
  SurfaceMesh (*make)();
  bool closed;
};

/// What the tests of invariants run on: at most 8,000 triangles each.
inline const std::vector<NamedSurface>& surfaces() {
  static const std::vector<NamedSurface> all{
      {"triangle",
       [] {
         return mesh_of({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, {{0, 1, 2}});
       },
       false},
      {"tetrahedron", [] { return tetrahedron(); }, true},
      {"sphere", [] { return bumpy_sphere(28); }, true},
      {"torus", [] { return bumpy_torus(72, 36); }, true},
      {"patch", [] { return wavy_patch(48); }, false},
      {"flat_patch",
       [] {
         auto m = wavy_patch(20);
         for (auto& p : m.positions) p.z = 0;
         return m;
       },
       false},
      {"cube", [] { return faceted_cube(20); }, true},
      {"vase", [] { return seamed_vase(48, 40); }, false},
      {"pebbles", [] { return pebbles(); }, true}};
  return all;
}

}  // namespace cuesta::test
