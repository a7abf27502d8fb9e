#include "apps/verify/cut_shape.h"

#include <algorithm>
#include <numeric>
#include <utility>

namespace cuesta::verify {

/// Between two points, with the direction in which one triangle runs along it.
struct SurfaceShape::Edge {
  std::uint32_t low, high;
  bool forward;
  friend auto operator<=>(const Edge&, const Edge&) = default;
  bool same_points(const Edge& e) const { return low == e.low && high == e.high; }
};

namespace {

constexpr auto before_by_points = [](const auto& a, const auto& b) {
  return std::pair(a.low, a.high) < std::pair(b.low, b.high);
};

constexpr std::uint32_t unused = 0xFFFFFFFFu;

std::uint32_t root(std::vector<std::uint32_t>& up, std::uint32_t p) {
  while (up[p] != p) p = up[p] = up[up[p]];
  return p;
}

/// Calls `visit(first edge, count, regular)` for each run of equal edges.
template <class Edges, class Visit>
void for_each_edge(const Edges& edges, const Visit& visit) {
  for (std::size_t i = 0, end = 0; i < edges.size(); i = end) {
    for (end = i + 1; end < edges.size() && edges[end].same_points(edges[i]);) ++end;
    const std::size_t n = end - i;
    visit(edges[i], n, n == 1 || (n == 2 && edges[i].forward != edges[i + 1].forward));
  }
}

}  // namespace

SurfaceShape::SurfaceShape(std::vector<std::uint32_t> point, std::span<const Triangle> full)
    : point_(std::move(point)) {
  find_components(full);
  const auto edges = sorted_edges(full);
  full_ = shapes_of(full, edges);
  for (const Triangle& t : full)
    for (std::size_t i = 0; i < 3; ++i) {
      const std::uint32_t a = point_[t[i]], b = point_[t[(i + 1) % 3]];
      const Edge e{std::min(a, b), std::max(a, b), a < b};
      const auto [first, last] = std::equal_range(edges.begin(), edges.end(), e, before_by_points);
      if (last - first == 1) border_.push_back({t[i], t[(i + 1) % 3]});
    }
}

void SurfaceShape::find_components(std::span<const Triangle> full) {
  std::vector<std::uint32_t> up(point_.size());
  std::iota(up.begin(), up.end(), 0u);
  for (const Triangle& t : full)
    for (const std::uint32_t v : {t[1], t[2]}) {
      const std::uint32_t a = root(up, point_[t[0]]), b = root(up, point_[v]);
      up[std::max(a, b)] = std::min(a, b);
    }
  component_.assign(point_.size(), unused);
  std::uint32_t count = 0;
  for (const Triangle& t : full) {
    std::uint32_t& number = component_[root(up, point_[t[0]])];
    if (number == unused) number = count++;
  }
  for (std::uint32_t p = 0; p < point_.size(); ++p) component_[p] = component_[root(up, p)];
  full_.resize(count);
}

std::vector<SurfaceShape::Edge> SurfaceShape::sorted_edges(std::span<const Triangle> triangles) const {
  std::vector<Edge> edges;
  edges.reserve(triangles.size() * 3);
  for (const Triangle& t : triangles)
    for (std::size_t i = 0; i < 3; ++i) {
      const std::uint32_t a = point_[t[i]], b = point_[t[(i + 1) % 3]];
      edges.push_back({std::min(a, b), std::max(a, b), a < b});
    }
  std::sort(edges.begin(), edges.end());
  return edges;
}

std::vector<ComponentShape> SurfaceShape::shapes_of(std::span<const Triangle> triangles,
                                                    std::span<const Edge> edges) const {
  std::vector<ComponentShape> shapes(full_.size());
  std::vector<std::uint8_t> used(point_.size(), 0);
  for (const Triangle& t : triangles) {
    ComponentShape& shape = shapes[component_[point_[t[0]]]];
    ++shape.euler;
    ++shape.triangles;
    for (std::uint32_t v : t)
      if (!std::exchange(used[point_[v]], std::uint8_t{1})) ++shape.euler;
  }
  for_each_edge(edges, [&](const Edge& e, std::size_t n, bool regular) {
    ComponentShape& shape = shapes[component_[e.low]];
    --shape.euler;
    shape.border_edges += n == 1;
    shape.irregular_edges += !regular;
  });
  return shapes;
}

/// Substitutions keep the parity of edges: the odd ones of a cut are the images of the full surface's border
/// edges, those that meet cancelled in pairs, whatever touches whatever. What differs is a crack.
std::uint64_t SurfaceShape::torn_edges(std::span<const Edge> edges,
                                       std::span<const std::uint32_t> ancestor) const {
  std::vector<Edge> all;
  for_each_edge(edges, [&](const Edge& e, std::size_t n, bool) {
    if (n % 2 == 1) all.push_back({e.low, e.high, true});
  });
  for (const auto& [from, to] : border_) {
    const std::uint32_t a = ancestor[point_[from]], b = ancestor[point_[to]];
    if (a != b) all.push_back({std::min(a, b), std::max(a, b), true});
  }
  std::sort(all.begin(), all.end());
  std::uint64_t torn = 0;
  for_each_edge(all, [&](const Edge&, std::size_t n, bool) { torn += n % 2; });
  return torn;
}

std::vector<std::string> SurfaceShape::complaints(std::span<const Triangle> cut,
                                                  std::span<const std::uint32_t> ancestor,
                                                  bool topology_kept) const {
  const auto edges = sorted_edges(cut);
  const auto shapes = shapes_of(cut, edges);
  std::vector<std::string> out;
  if (const std::uint64_t torn = torn_edges(edges, ancestor); torn > 0)
    out.push_back(std::to_string(torn) + " edges are cracks: not images of the full surface's border");
  for (std::size_t c = 0; c < shapes.size(); ++c) {
    const ComponentShape &now = shapes[c], &full = full_[c];
    const std::string where = " in component " + std::to_string(c);
    if (now.border_edges > full.border_edges)
      out.push_back(std::to_string(now.border_edges) + " border edges" + where + ", the full surface has " +
                    std::to_string(full.border_edges));
    if (!topology_kept) continue;
    if (now.irregular_edges > full.irregular_edges)
      out.push_back(std::to_string(now.irregular_edges) + " non-manifold edges" + where);
    else if (full.border_edges == 0 && now.triangles > 0 && now.euler != full.euler)
      out.push_back("Euler characteristic " + std::to_string(now.euler) + where + ", the full surface has " +
                    std::to_string(full.euler));
  }
  return out;
}

}  // namespace cuesta::verify
