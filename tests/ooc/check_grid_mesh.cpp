#include "tests/ooc/check_grid_mesh.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <tuple>

namespace cuesta::test {
namespace {

using Triangle = std::array<std::uint32_t, 3>;

template <class... Parts>
std::string sentence(const Parts&... parts) {
  const auto text = [](const auto& p) {
    if constexpr (std::is_arithmetic_v<std::remove_cvref_t<decltype(p)>>)
      return std::to_string(p);
    else
      return std::string(p);
  };
  return (text(parts) + ...);
}

std::string check_sizes(const GridMesh& mesh) {
  const std::size_t n = mesh.positions.size();
  const auto wrong = [n](const char* what, std::size_t size) {
    return sentence("there are ", size, " ", what, " for ", n, " vertices");
  };
  const auto fits = [n](const auto& values) { return values.empty() || values.size() == n; };
  if (!fits(mesh.normals)) return wrong("normals", mesh.normals.size());
  if (!fits(mesh.colours)) return wrong("colours", mesh.colours.size());
  if (!fits(mesh.texcoords)) return wrong("texture coordinates", mesh.texcoords.size());
  if (mesh.wedge_group.size() != n) return wrong("wedge groups", mesh.wedge_group.size());
  if (mesh.triangles.empty()) return "there is no triangle";
  return "";
}

std::string check_grid(const GridMesh& mesh) {
  const Grid& grid = mesh.grid;
  if (!(grid.step > 0) || std::isinf(grid.step)) return sentence("the grid step is ", grid.step);
  if (!std::isfinite(grid.origin.x + grid.origin.y + grid.origin.z)) return "the grid origin is not finite";
  for (std::size_t v = 0; v < mesh.positions.size(); ++v)
    for (int k = 0; k < 3; ++k)
      if (mesh.positions[v][k] < 0 || mesh.positions[v][k] >= 1 << 30)
        return sentence("coordinate ", k, " of vertex ", v, " is ", mesh.positions[v][k],
                        ", not in [0, 2^30)");
  return "";
}

std::string check_groups(const GridMesh& mesh) {
  const auto& group = mesh.wedge_group;
  for (std::size_t v = 0; v < group.size(); ++v) {
    if (group[v] == v) continue;
    if (v == 0 || group[v] != group[v - 1])
      return sentence("vertex ", v, " is in group ", group[v], " but not consecutive with it");
    if (mesh.positions[v] != mesh.positions[group[v]])
      return sentence("vertex ", v, " is not at the position of its group ", group[v]);
  }
  return "";
}

std::string check_indices(const GridMesh& mesh) {
  const std::size_t n = mesh.positions.size();
  std::vector<bool> used(n, false);
  for (std::size_t i = 0; i < mesh.triangles.size(); ++i)
    for (const std::uint32_t v : mesh.triangles[i]) {
      if (v >= n) return sentence("triangle ", i, " uses vertex ", v, " of ", n);
      used[v] = true;
    }
  const auto unused = std::find(used.begin(), used.end(), false);
  return unused == used.end() ? "" : sentence("vertex ", unused - used.begin(), " is not used by a triangle");
}

std::string check_order(const GridMesh& mesh) {
  for (std::size_t i = 0; i < mesh.triangles.size(); ++i) {
    const Triangle& t = mesh.triangles[i];
    if (t[1] < t[0] || t[2] < t[0]) return sentence("triangle ", i, " does not start at its lowest vertex");
    if (i > 0 && t < mesh.triangles[i - 1]) return sentence("triangle ", i, " is out of order");
  }
  return "";
}

Triangle groups_of(const GridMesh& mesh, std::size_t i) {
  const Triangle& t = mesh.triangles[i];
  return {mesh.wedge_group[t[0]], mesh.wedge_group[t[1]], mesh.wedge_group[t[2]]};
}

std::string check_faces(const GridMesh& mesh) {
  std::vector<std::pair<Triangle, std::size_t>> faces;
  faces.reserve(mesh.triangles.size());
  for (std::size_t i = 0; i < mesh.triangles.size(); ++i) {
    Triangle g = groups_of(mesh, i);
    std::ranges::sort(g);
    if (g[0] == g[1] || g[1] == g[2]) return sentence("triangle ", i, " uses group ", g[1], " twice");
    faces.emplace_back(g, i);
  }
  std::ranges::sort(faces);
  for (std::size_t i = 1; i < faces.size(); ++i)
    if (faces[i].first == faces[i - 1].first)
      return sentence("triangles ", faces[i - 1].second, " and ", faces[i].second,
                      " use the same three groups");
  return "";
}

struct HalfEdge {
  std::uint32_t lo, hi;  ///< groups
  std::size_t corner;    ///< 3 · triangle + corner that it starts from
  bool up;               ///< from lo to hi

  static HalfEdge of(const GridMesh& mesh, std::size_t corner) {
    const Triangle g = groups_of(mesh, corner / 3);
    const std::uint32_t from = g[corner % 3], to = g[(corner + 1) % 3];
    return {std::min(from, to), std::max(from, to), corner, from < to};
  }
  bool same_edge(const HalfEdge& o) const { return lo == o.lo && hi == o.hi; }
};

std::vector<HalfEdge> sorted_half_edges(const GridMesh& mesh) {
  std::vector<HalfEdge> edges;
  edges.reserve(mesh.triangles.size() * 3);
  for (std::size_t c = 0; c < mesh.triangles.size() * 3; ++c) edges.push_back(HalfEdge::of(mesh, c));
  std::ranges::sort(edges, {}, [](const HalfEdge& e) { return std::tie(e.lo, e.hi, e.corner); });
  return edges;
}

std::string check_edges(const std::vector<HalfEdge>& edges) {
  for (std::size_t i = 1; i < edges.size(); ++i) {
    if (!edges[i].same_edge(edges[i - 1])) continue;
    const auto bad = [&](const char* what) {
      return sentence("the edge of groups ", edges[i].lo, " and ", edges[i].hi, what, edges[i].corner / 3);
    };
    if (i > 1 && edges[i].same_edge(edges[i - 2])) return bad(" has a third triangle, ");
    if (edges[i].up == edges[i - 1].up) return bad(" has a second triangle in the same direction, ");
  }
  return "";
}

/// Sets of corners that are joined across edges.
class CornerSets {
 public:
  explicit CornerSets(std::size_t corners) {
    parent_.reserve(corners);
    for (std::size_t c = 0; c < corners; ++c) parent_.push_back(c);
  }
  std::size_t root(std::size_t c) {
    while (parent_[c] != c) c = parent_[c] = parent_[parent_[c]];
    return c;
  }
  void join(std::size_t a, std::size_t b) {
    parent_[std::max(root(a), root(b))] = std::min(root(a), root(b));
  }

 private:
  std::vector<std::size_t> parent_;
};

/// With every edge sound, a connected star is one fan or half-fan.
std::string check_fans(const GridMesh& mesh, const std::vector<HalfEdge>& edges) {
  CornerSets sets(mesh.triangles.size() * 3);
  const auto next = [](std::size_t corner) { return corner % 3 == 2 ? corner - 2 : corner + 1; };
  for (std::size_t i = 1; i < edges.size(); ++i)
    if (edges[i].same_edge(edges[i - 1])) {  // opposite directions: the start of one is the end of the other
      sets.join(edges[i].corner, next(edges[i - 1].corner));
      sets.join(next(edges[i].corner), edges[i - 1].corner);
    }
  constexpr std::size_t none = static_cast<std::size_t>(-1);
  std::vector<std::size_t> fan_of(mesh.positions.size(), none);
  for (std::size_t c = 0; c < mesh.triangles.size() * 3; ++c) {
    std::size_t& fan = fan_of[groups_of(mesh, c / 3)[c % 3]];
    if (fan == none) fan = sets.root(c);
    if (fan != sets.root(c))
      return sentence("the triangles around group ", groups_of(mesh, c / 3)[c % 3],
                      " are more than one fan: ", fan / 3, " and ", c / 3, " are not connected");
  }
  return "";
}

}  // namespace

std::string find_violation(const GridMesh& mesh) {
  for (const auto check : {check_sizes, check_grid, check_groups, check_indices, check_order, check_faces})
    if (std::string found = check(mesh); !found.empty()) return found;
  const std::vector<HalfEdge> edges = sorted_half_edges(mesh);
  if (std::string found = check_edges(edges); !found.empty()) return found;
  return check_fans(mesh, edges);
}

}  // namespace cuesta::test
