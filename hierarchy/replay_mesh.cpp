#include "hierarchy/replay_mesh.h"

#include <algorithm>
#include <numeric>
#include <utility>

namespace cuesta {

std::vector<std::uint32_t> points_of(const Page& page) {
  std::vector<std::uint32_t> point(page.vertex_count);
  std::iota(point.begin(), point.end(), 0u);
  for (std::uint32_t v : page.wedge_tails) point[v] = point[v - 1];
  return point;
}

ReplayMesh::ReplayMesh(const Page& page, std::span<const Vec3i> positions)
    : positions_(positions),
      corners_(page.triangles),
      point_(points_of(page)),
      alive_(page.triangles.size(), 1),
      stars_(page.vertex_count) {
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
