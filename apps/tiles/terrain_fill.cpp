#include "apps/tiles/terrain_fill.h"

#include <map>
#include <set>

#include "terrain/constrained_delaunay.h"

namespace cuesta::tiles {
namespace {

using Edge = std::array<std::uint32_t, 2>;
enum class Kind : std::uint8_t { unknown, ground, fill };

/// Each point of the lattice once, though walls have several vertices above it.
class Plane {
 public:
  std::vector<GridPoint> points;
  std::vector<std::uint32_t> vertex;  // of the mesh, by point

  std::uint32_t point(const TerrainTileMesh& tile, std::uint32_t v) {
    const TerrainVertex& at = tile.vertices[v];
    const auto [found, is_new] =
        numbers_.try_emplace({at.u, at.v}, static_cast<std::uint32_t>(points.size()));
    if (is_new) {
      points.push_back({at.u, at.v});
      vertex.push_back(v);
    }
    return found->second;
  }

 private:
  std::map<std::pair<std::int32_t, std::int32_t>, std::uint32_t> numbers_;
};

/// Directed, with the mesh on their left.
std::set<Edge> border_edges(const TerrainTileMesh& tile, Plane& plane) {
  std::set<Edge> vertex_edges, edges;
  for (const auto& t : tile.triangles)
    for (std::size_t i = 0; i < 3; ++i) vertex_edges.insert({t[i], t[(i + 1) % 3]});
  for (const Edge& e : vertex_edges) {
    if (vertex_edges.contains({e[1], e[0]})) continue;
    const Edge flat{plane.point(tile, e[0]), plane.point(tile, e[1])};
    if (flat[0] != flat[1]) edges.insert(flat);
  }
  return edges;
}

/// Which triangles are the mesh's own ground: left of its borders, and what no border divides from them.
std::vector<Kind> kinds_of(const Triangulation& net, const std::set<Edge>& edges) {
  std::vector<Kind> kinds(net.triangles.size(), Kind::unknown);
  std::vector<std::uint32_t> stack;
  const auto mark = [&](std::uint32_t t, Kind kind) {
    if (kinds[t] != Kind::unknown) return;
    kinds[t] = kind;
    stack.push_back(t);
  };
  for (std::uint32_t t = 0; t < net.triangles.size(); ++t) {
    const DelaunayTriangle& d = net.triangles[t];
    for (std::size_t i = 0; i < 3; ++i) {
      const Edge e{d.points[(i + 1) % 3], d.points[(i + 2) % 3]};
      if (edges.contains(e)) mark(t, Kind::ground);
      if (edges.contains({e[1], e[0]})) mark(t, Kind::fill);
    }
  }
  while (!stack.empty()) {
    const std::uint32_t t = stack.back();
    stack.pop_back();
    const DelaunayTriangle& d = net.triangles[t];
    for (std::size_t i = 0; i < 3; ++i)
      if (d.across[i] != DelaunayTriangle::none && !d.is_segment[i]) mark(d.across[i], kinds[t]);
  }
  return kinds;
}

}  // namespace

void fill_around(TerrainTileMesh& tile, double h_m, Vec3f up) {
  Plane plane;
  const std::set<Edge> edges = border_edges(tile, plane);
  for (const std::int32_t u : {0, terrain_steps})
    for (const std::int32_t v : {0, terrain_steps}) {
      tile.vertices.push_back({u, v, h_m, up});
      plane.point(tile, static_cast<std::uint32_t>(tile.vertices.size() - 1));
    }
  std::vector<Edge> segments(edges.begin(), edges.end());
  std::erase_if(segments, [&](const Edge& e) { return e[0] > e[1] && edges.contains({e[1], e[0]}); });
  const Triangulation net = triangulate(plane.points, segments);
  const auto kinds = kinds_of(net, edges);
  for (std::size_t t = 0; t < net.triangles.size(); ++t) {
    if (kinds[t] == Kind::ground) continue;
    const auto& p = net.triangles[t].points;
    tile.triangles.push_back({plane.vertex[p[0]], plane.vertex[p[1]], plane.vertex[p[2]]});
  }
}

}  // namespace cuesta::tiles
