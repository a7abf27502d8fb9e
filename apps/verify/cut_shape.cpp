#include "apps/verify/cut_shape.h"

#include <algorithm>
#include <numeric>
#include <utility>

#include "hierarchy/seam_groups.h"

namespace cuesta::verify {

/// Between two points, with the direction in which one triangle runs along it.
struct SurfaceShape::Edge {
  std::uint32_t low, high;
  bool forward;
  friend auto operator<=>(const Edge&, const Edge&) = default;
  bool same_points(const Edge& e) const { return low == e.low && high == e.high; }
};

namespace {

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

SurfaceShape::SurfaceShape(std::span<const Vec3i> positions, std::span<const Triangle> full)
    : point_(seam_groups(positions, full)), at_border_(positions.size(), 0) {
  find_components(full);
  const auto edges = sorted_edges(full);
  full_ = shapes_of(full, edges);
  for_each_edge(edges, [this](const Edge& e, std::size_t n, bool) {
    if (n == 1) at_border_[e.low] = at_border_[e.high] = 1;
  });
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

/// Substitutions keep the parity of edges: an odd one away from the border is a crack, whatever touches
/// whatever. Where topology was let go a border may have moved inwards, to any point of its component.
std::uint64_t SurfaceShape::torn_edges(std::span<const Edge> edges, bool topology_kept) const {
  std::uint64_t torn = 0;
  for_each_edge(edges, [&](const Edge& e, std::size_t n, bool) {
    const bool border =
        topology_kept ? at_border_[e.low] && at_border_[e.high] : full_[component_[e.low]].border_edges > 0;
    torn += n % 2 == 1 && !border;
  });
  return torn;
}

std::vector<std::string> SurfaceShape::complaints(std::span<const Triangle> cut, bool topology_kept) const {
  const auto edges = sorted_edges(cut);
  const auto shapes = shapes_of(cut, edges);
  std::vector<std::string> out;
  if (const std::uint64_t torn = torn_edges(edges, topology_kept); torn > 0)
    out.push_back(std::to_string(torn) + " border edges where the full surface has no border");
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
