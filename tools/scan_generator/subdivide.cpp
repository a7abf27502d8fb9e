#include "tools/scan_generator/subdivide.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>

#include "ooc/check.h"

namespace cuesta::tools {
namespace {

constexpr std::uint32_t none = 0xffffffffu;

struct Edge {
  std::uint32_t a, b;                       ///< a < b
  std::uint32_t left = none, right = none;  ///< corners across; right == none on a border
};

/// Edges by (a, b); of_corner[3t + i] is the edge from corner i of triangle t to corner i + 1.
struct EdgeTable {
  std::vector<Edge> edges;
  std::vector<std::uint32_t> of_corner;
};

struct HalfEdge {
  std::uint32_t a, b, across;
};

HalfEdge half_edge(const SurfaceMesh& mesh, std::uint32_t corner) {
  const auto& t = mesh.triangles[corner / 3];
  const std::uint32_t i = corner % 3, from = t[i], to = t[(i + 1) % 3];
  return {std::min(from, to), std::max(from, to), t[(i + 2) % 3]};
}

/// Corners grouped by the smaller vertex of their edge: group v is corners[start[v] … start[v + 1]).
void group_corners(const SurfaceMesh& mesh, std::vector<std::uint32_t>& start,
                   std::vector<std::uint32_t>& corners) {
  const auto n = static_cast<std::uint32_t>(mesh.triangles.size() * 3);
  start.assign(mesh.positions.size() + 2, 0);
  corners.resize(n);
  for (std::uint32_t c = 0; c < n; ++c) ++start[half_edge(mesh, c).a + 2];
  for (std::size_t v = 2; v < start.size(); ++v) start[v] += start[v - 1];
  for (std::uint32_t c = 0; c < n; ++c) corners[start[half_edge(mesh, c).a + 1]++] = c;
}

Result<void> add_corner(const HalfEdge& h, std::size_t first_of_group, std::vector<Edge>& edges) {
  if (edges.size() == first_of_group || edges.back().b != h.b) {
    edges.push_back({h.a, h.b, h.across, none});
  } else if (edges.back().right == none) {
    edges.back().right = h.across;
  } else {
    return fail(ErrorCode::invalid_input, "",
                "vertices " + std::to_string(h.a) + " and " + std::to_string(h.b),
                "expected at most two triangles at an edge, found three; give a manifold mesh");
  }
  return {};
}

Result<EdgeTable> find_edges(const SurfaceMesh& mesh) {
  EdgeTable table;
  std::vector<std::uint32_t> start, corners;
  group_corners(mesh, start, corners);
  table.of_corner.resize(corners.size());
  table.edges.reserve(corners.size() / 2 + 1);
  for (std::size_t v = 0; v < mesh.positions.size(); ++v) {
    const auto first = corners.begin() + start[v], last = corners.begin() + start[v + 1];
    std::sort(first, last, [&](std::uint32_t c, std::uint32_t d) {
      const std::uint32_t cb = half_edge(mesh, c).b, db = half_edge(mesh, d).b;
      return cb != db ? cb < db : c < d;
    });
    const std::size_t first_of_group = table.edges.size();
    for (auto c = first; c != last; ++c) {
      if (auto added = add_corner(half_edge(mesh, *c), first_of_group, table.edges); !added)
        return fail(added.error());
      table.of_corner[*c] = static_cast<std::uint32_t>(table.edges.size() - 1);
    }
  }
  return table;
}

/// What each vertex rule needs: the neighbours that count, which on a border are those along it.
struct Neighbours {
  std::vector<Vec3d> sum;
  std::vector<std::uint32_t> count;
  std::vector<bool> on_border;
};

Neighbours gather(const SurfaceMesh& mesh, const std::vector<Edge>& edges) {
  const std::size_t n = mesh.positions.size();
  Neighbours around{std::vector<Vec3d>(n), std::vector<std::uint32_t>(n), std::vector<bool>(n)};
  for (const Edge& e : edges) {
    if (e.right == none) around.on_border[e.a] = around.on_border[e.b] = true;
  }
  for (const Edge& e : edges) {
    const auto add = [&](std::uint32_t v, std::uint32_t neighbour) {
      if (around.on_border[v] && e.right != none) return;
      around.sum[v] = around.sum[v] + mesh.positions[neighbour];
      ++around.count[v];
    };
    add(e.a, e.b);
    add(e.b, e.a);
  }
  return around;
}

Vec3d vertex_point(Vec3d p, const Neighbours& around, std::size_t v) {
  const double n = around.count[v];
  if (around.on_border[v]) return n == 2 ? p * 0.75 + around.sum[v] * 0.125 : p;
  if (n == 0) return p;
  const double c = 0.375 + 0.25 * std::cos(2 * std::numbers::pi / n);
  const double beta = (0.625 - c * c) / n;
  return p * (1 - n * beta) + around.sum[v] * beta;
}

Vec3d edge_point(const std::vector<Vec3d>& p, const Edge& e) {
  if (e.right == none) return (p[e.a] + p[e.b]) * 0.5;
  return (p[e.a] + p[e.b]) * 0.375 + (p[e.left] + p[e.right]) * 0.125;
}

Result<void> check_input(const SurfaceMesh& mesh) {
  CUESTA_CHECK(is_consistent(mesh));
  if (mesh.triangles.size() >= (1u << 29)) {
    return fail(ErrorCode::out_of_budget, "", "", "a further level would have 2^31 triangles or more");
  }
  for (std::size_t i = 0; i < mesh.triangles.size(); ++i) {
    const auto& t = mesh.triangles[i];
    if (t[0] != t[1] && t[1] != t[2] && t[2] != t[0]) continue;
    return fail(ErrorCode::invalid_input, "", "triangle " + std::to_string(i),
                "a triangle has a repeated vertex");
  }
  return {};
}

}  // namespace

Result<SurfaceMesh> subdivide_loop(const SurfaceMesh& mesh) {
  if (auto ok = check_input(mesh); !ok) return fail(ok.error());
  Result<EdgeTable> table = find_edges(mesh);
  if (!table) return fail(table.error());
  SurfaceMesh fine;
  const auto old = static_cast<std::uint32_t>(mesh.positions.size());
  fine.positions.reserve(old + table->edges.size());
  {
    const Neighbours around = gather(mesh, table->edges);
    for (std::uint32_t v = 0; v < old; ++v)
      fine.positions.push_back(vertex_point(mesh.positions[v], around, v));
  }
  for (const Edge& e : table->edges) fine.positions.push_back(edge_point(mesh.positions, e));
  std::vector<Edge>().swap(table->edges);
  fine.triangles.reserve(mesh.triangles.size() * 4);
  for (std::size_t i = 0; i < mesh.triangles.size(); ++i) {
    const auto [a, b, c] = mesh.triangles[i];
    const std::uint32_t* e = &table->of_corner[3 * i];
    const std::uint32_t ab = old + e[0], bc = old + e[1], ca = old + e[2];
    fine.triangles.push_back({a, ab, ca});
    fine.triangles.push_back({ab, b, bc});
    fine.triangles.push_back({ca, bc, c});
    fine.triangles.push_back({ab, bc, ca});
  }
  return fine;
}

}  // namespace cuesta::tools
