#include "ooc/border_points.h"

#include <algorithm>
#include <array>
#include <utility>

#include "ooc/face_filter.h"
#include "ooc/weld.h"

namespace cuesta {
namespace {

/// Lower vertex first.
using Edge = std::array<std::uint32_t, 2>;

/// Of triangles without fault, those edges that have an end in the box: all their triangles are in the soup.
std::vector<Edge> edges_of(const std::vector<Triangle>& triangles, const std::vector<FaceFault>& faults,
                           const std::vector<std::uint8_t>& home) {
  std::vector<Edge> edges;
  edges.reserve(3 * triangles.size());
  for (std::size_t i = 0; i < triangles.size(); ++i) {
    if (faults[i] != FaceFault::none) continue;
    for (std::size_t k = 0; k < 3; ++k) {
      const std::uint32_t a = triangles[i][k], b = triangles[i][(k + 1) % 3];
      if (home[a] || home[b]) edges.push_back({std::min(a, b), std::max(a, b)});
    }
  }
  return edges;
}

/// Per vertex whether an edge of it is there once only.
std::vector<std::uint8_t> open_vertices(std::vector<Edge> edges, std::size_t vertices) {
  std::sort(edges.begin(), edges.end());
  std::vector<std::uint8_t> open(vertices, 0);
  for (std::size_t begin = 0, end = 0; begin < edges.size(); begin = end) {
    for (end = begin + 1; end < edges.size() && edges[end] == edges[begin];) ++end;
    if (end - begin == 1) open[edges[begin][0]] = open[edges[begin][1]] = 1;
  }
  return open;
}

}  // namespace

std::vector<BorderPoint> border_points(TriangleSoup soup, const Box3<float>& box) {
  VertexTable points;  // without attributes
  points.positions = std::move(soup.corners.positions);
  soup.corners = {};
  soup.area_normals = {};
  const Welded welded = weld(points);
  std::vector<Triangle> triangles(soup.size());
  for (std::size_t i = 0; i < triangles.size(); ++i)
    triangles[i] = {welded.of[3 * i], welded.of[3 * i + 1], welded.of[3 * i + 2]};
  const std::size_t vertices = welded.source.size();
  const auto position = [&](std::uint32_t v) { return points.positions[welded.source[v]]; };
  std::vector<std::uint8_t> home(vertices);
  for (std::uint32_t v = 0; v < vertices; ++v) home[v] = holds(box, vec_cast<float>(position(v)));
  const auto open = open_vertices(edges_of(triangles, face_faults(triangles, welded.group), home), vertices);

  std::vector<std::pair<std::uint32_t, std::uint32_t>> uses;  // vertex, chunk
  for (std::size_t i = 0; i < triangles.size(); ++i)
    for (const std::uint32_t v : triangles[i])
      if (home[v] && open[v]) uses.emplace_back(v, soup.owners[i]);
  std::sort(uses.begin(), uses.end());
  uses.erase(std::unique(uses.begin(), uses.end()), uses.end());
  std::vector<BorderPoint> out;
  out.reserve(uses.size());
  for (const auto& [v, chunk] : uses) out.push_back({position(v), chunk});
  return out;
}

}  // namespace cuesta
