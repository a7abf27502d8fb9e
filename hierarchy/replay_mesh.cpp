#include "hierarchy/replay_mesh.h"

#include <algorithm>
#include <numeric>
#include <utility>

namespace cuesta {
namespace {

std::uint32_t root(std::vector<std::uint32_t>& point, std::uint32_t v) {
  while (point[v] != v) v = point[v] = point[point[v]];
  return v;
}

void join(std::vector<std::uint32_t>& point, std::uint32_t a, std::uint32_t b) {
  a = root(point, a);
  b = root(point, b);
  point[std::max(a, b)] = std::min(a, b);
}

/// Wedges that are joined and leave one position are one point. (A component that is absorbed leaves
/// several.)
void join_children(std::span<const Child> children, std::span<const Vec3i> positions,
                   std::vector<std::uint32_t>& point) {
  for (std::size_t first = 0, last = 0; first < children.size(); first = last) {
    bool one_place = true;
    for (last = first + 1; last < children.size() && children[last].joined; ++last)
      one_place = one_place && positions[children[last].vertex] == positions[children[first].vertex];
    for (std::size_t i = first + 1; i < last && one_place; ++i)
      join(point, children[first].vertex, children[i].vertex);
  }
}

/// So are those that the children of one fan go to. More wedges may be one point, which only makes the checks
/// here milder; edges cannot tell, for a page holds only some of the sheets that meet at a non-manifold edge.
void join_wedges(const Script& script, std::span<const Vec3i> positions, std::vector<std::uint32_t>& point) {
  join_children(script.children, positions, point);
  for (const Fan& fan : script.fans)
    for (const Child& c : std::span(script.children).subspan(fan.first_child, fan.child_count))
      if (positions[c.target] == positions[fan.centre]) join(point, fan.centre, c.target);
  for (std::uint32_t v = 0; v < point.size(); ++v) point[v] = root(point, v);
}

}  // namespace

std::uint32_t loop_count(std::span<const std::array<std::uint32_t, 3>> triangles,
                         std::span<const std::uint32_t> point) {
  std::vector<std::uint32_t> component(point.size());
  std::iota(component.begin(), component.end(), 0u);
  std::vector<std::pair<std::uint32_t, std::uint32_t>> edges;
  for (const auto& t : triangles)
    for (std::size_t i = 0; i < 3; ++i) {
      const std::uint32_t a = point[t[i]], b = point[t[(i + 1) % 3]];
      edges.emplace_back(std::min(a, b), std::max(a, b));
      join(component, a, b);
    }
  std::sort(edges.begin(), edges.end());
  edges.erase(std::unique(edges.begin(), edges.end()), edges.end());
  // Points less components: each step that joins two of them takes one.
  std::int64_t joins = 0;
  for (std::uint32_t p = 0; p < component.size(); ++p) joins += component[p] != p;
  const auto loops =
      static_cast<std::int64_t>(edges.size()) - static_cast<std::int64_t>(triangles.size()) - joins;
  return static_cast<std::uint32_t>(std::max<std::int64_t>(0, loops));
}

ReplayMesh::ReplayMesh(const Page& page, std::span<const Vec3i> positions)
    : positions_(positions),
      corners_(page.triangles),
      point_(page.vertex_count),
      alive_(page.triangles.size(), 1),
      stars_(page.vertex_count) {
  std::iota(point_.begin(), point_.end(), 0u);
  join_wedges(page.script, positions, point_);
  for (std::uint32_t t = 0; t < corners_.size(); ++t)
    for (std::uint32_t v : corners_[t]) {
      auto& star = stars_[point_[v]];
      if (star.empty() || star.back() != t) star.push_back(t);
    }
}

bool ReplayMesh::has_point(std::uint32_t t, std::uint32_t p) const {
  const auto& c = corners_[t];
  return point_[c[0]] == p || point_[c[1]] == p || point_[c[2]] == p;
}

std::span<const std::uint32_t> ReplayMesh::star(std::uint32_t p) {
  auto& star = stars_[p];
  std::erase_if(star, [this](std::uint32_t t) { return !alive_[t]; });
  return star;
}

std::vector<std::uint32_t> ReplayMesh::ring(std::uint32_t p) {
  std::vector<std::uint32_t> out;
  for (std::uint32_t t : star(p))
    for (std::uint32_t v : corners_[t])
      if (point_[v] != p) out.push_back(point_[v]);
  std::sort(out.begin(), out.end());
  out.erase(std::unique(out.begin(), out.end()), out.end());
  return out;
}

Vec3d ReplayMesh::normal(const std::array<std::uint32_t, 3>& c) const {
  const Vec3d a = position(c[0]);
  return cross(position(c[1]) - a, position(c[2]) - a);
}

std::array<std::uint32_t, 3> ReplayMesh::substituted(std::uint32_t t, std::span<const Child> run) const {
  auto c = corners_[t];
  for (std::uint32_t& v : c)
    for (const Child& child : run)
      if (v == child.vertex) {
        v = child.target;
        break;
      }
  return c;
}

std::uint32_t ReplayMesh::edge_triangles(std::uint32_t p, std::uint32_t q) {
  const auto around = star(p);
  return static_cast<std::uint32_t>(
      std::count_if(around.begin(), around.end(), [&](std::uint32_t t) { return has_point(t, q); }));
}

void ReplayMesh::remove(std::uint32_t triangle) {
  alive_[triangle] = 0;
}

std::uint32_t ReplayMesh::substitute(std::span<const Child> run) {
  const std::uint32_t u = point_[run[0].vertex], v = point_[run[0].target];
  std::uint32_t died = 0;
  auto& target = stars_[v];
  for (std::uint32_t t : star(u)) {
    if (has_point(t, v)) {
      alive_[t] = 0;
      ++died;
      continue;
    }
    corners_[t] = substituted(t, run);
    target.insert(std::upper_bound(target.begin(), target.end(), t), t);
  }
  stars_[u].clear();
  return died;
}

}  // namespace cuesta
