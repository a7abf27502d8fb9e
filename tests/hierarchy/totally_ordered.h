#pragma once
/// Total orders for tests of strips, and what any of them must draw, by brute force.

#include <algorithm>
#include <numeric>
#include <random>
#include <set>
#include <span>
#include <vector>

#include "hierarchy/strip_sides.h"
#include "ooc/surface_mesh.h"

namespace cuesta::test {

/// Vertices 0 to r - 1 are those of resolution r; substitute[v] < v, but for v < base.
struct TotallyOrdered {
  std::vector<Triangle> triangles;
  std::vector<std::uint32_t> substitute;
  std::uint32_t base = 1;
  std::vector<std::uint32_t> number = {};  ///< of each vertex of the surface it was made from

  std::uint32_t full() const { return static_cast<std::uint32_t>(substitute.size()); }
};

inline bool has_repeated_corner(const Triangle& t) {
  return t[0] == t[1] || t[1] == t[2] || t[2] == t[0];
}

/// What is drawn at resolution r.
inline std::vector<Triangle> brute_force(const TotallyOrdered& mesh, std::uint32_t r) {
  std::vector<Triangle> drawn;
  for (Triangle t : mesh.triangles) {
    for (std::uint32_t& v : t)
      while (v >= r) v = mesh.substitute[v];
    if (!has_repeated_corner(t)) drawn.push_back(smallest_first(t));
  }
  std::sort(drawn.begin(), drawn.end());
  return drawn;
}

inline std::vector<Triangle> sorted(std::span<const Triangle> triangles) {
  std::vector<Triangle> out;
  for (const Triangle& t : triangles) out.push_back(smallest_first(t));
  std::sort(out.begin(), out.end());
  return out;
}

/// As GL_TRIANGLE_STRIP with primitive restart draws; degenerate triangles left out.
inline std::vector<Triangle> drawn_by(std::span<const std::uint32_t> indices) {
  std::vector<Triangle> drawn;
  std::size_t begin = 0;
  for (std::size_t i = 0; i < indices.size(); ++i) {
    if (indices[i] == strip_restart) begin = i + 1;
    if (i < begin + 2) continue;
    Triangle t{indices[i - 2], indices[i - 1], indices[i]};
    if ((i - begin) % 2 == 1) std::swap(t[0], t[1]);
    if (!has_repeated_corner(t)) drawn.push_back(t);
  }
  return sorted(drawn);
}

/// Every vertex to any one before it, edge or not: what no simplifier does, and strips must stand.
inline TotallyOrdered random_order(std::vector<Triangle> triangles, std::uint32_t vertices,
                                   std::uint32_t base, std::uint32_t seed) {
  std::mt19937 random(seed);
  TotallyOrdered mesh{std::move(triangles), std::vector<std::uint32_t>(vertices), base};
  for (std::uint32_t v = base; v < vertices; ++v)
    mesh.substitute[v] = static_cast<std::uint32_t>(random() % v);
  return mesh;
}

/// Collapses edges of a clean surface in random order while both ends have no more than their edge's
/// triangles in common (the link condition), so that it stays a manifold; borders move along themselves only.
inline TotallyOrdered collapse_order(const SurfaceMesh& surface, std::uint32_t seed,
                                     StripSides* sides = nullptr) {
  std::mt19937 random(seed);
  const auto n = static_cast<std::uint32_t>(surface.positions.size());
  std::vector<Triangle> now = surface.triangles;
  std::vector<std::set<std::uint32_t>> near(n), star(n);
  for (std::uint32_t t = 0; t < now.size(); ++t)
    for (const std::uint32_t v : now[t])
      for (const std::uint32_t w : now[t]) {
        star[v].insert(t);
        if (v != w) near[v].insert(w);
      }
  const auto on_border = [&](std::uint32_t v) { return near[v].size() != star[v].size(); };
  std::vector<std::uint32_t> queue(n), order, target(n);
  std::iota(queue.begin(), queue.end(), 0u);
  for (bool any = true; any;) {
    any = false;
    std::shuffle(queue.begin(), queue.end(), random);
    for (const std::uint32_t u : std::vector(queue)) {
      for (const std::uint32_t v : near[u]) {
        std::vector<std::uint32_t> common, shared;
        std::set_intersection(near[u].begin(), near[u].end(), near[v].begin(), near[v].end(),
                              std::back_inserter(common));
        std::set_intersection(star[u].begin(), star[u].end(), star[v].begin(), star[v].end(),
                              std::back_inserter(shared));
        if (common.size() != shared.size() || shared.size() != (on_border(u) ? 1u : 2u) ||
            near[u].size() < 3 || near[v].size() < 4 || (sides && !sides->allows(u, v)))
          continue;
        if (sides) sides->applied(u, v, std::vector(near[u].begin(), near[u].end()), common);
        for (const std::uint32_t t : shared)
          for (const std::uint32_t w : now[t]) star[w].erase(t);
        for (const std::uint32_t t : star[u]) {
          std::replace(now[t].begin(), now[t].end(), u, v);
          star[v].insert(t);
        }
        for (const std::uint32_t w : near[u]) {
          near[w].erase(u);
          if (w != v) near[w].insert(v), near[v].insert(w);
        }
        near[u].clear();
        star[u].clear();
        order.push_back(u);
        target[u] = v;
        std::erase(queue, u);
        any = true;
        break;
      }
    }
  }
  TotallyOrdered mesh{surface.triangles, std::vector<std::uint32_t>(n),
                      n - static_cast<std::uint32_t>(order.size())};
  std::vector<std::uint32_t> number(n);
  for (std::uint32_t i = 0; i < queue.size(); ++i) number[queue[i]] = i;
  for (std::uint32_t i = 0; i < order.size(); ++i) number[order[i]] = n - 1 - i;
  for (const std::uint32_t u : order) mesh.substitute[number[u]] = number[target[u]];
  for (Triangle& t : mesh.triangles)
    for (std::uint32_t& v : t) v = number[v];
  mesh.number = std::move(number);
  return mesh;
}

}  // namespace cuesta::test
