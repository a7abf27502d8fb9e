/// The guarantees of the view-dependence tree: a baseline that cheats or breaks is worth nothing.

#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <set>

#include "tests/hierarchy/surfaces.h"
#include "tools/baselines/vdt_cut.h"

namespace cuesta::test {
namespace {

using baselines::no_node;
using baselines::NodeId;
using baselines::VdtCut;
using baselines::ViewDependenceTree;
using Triangle = std::array<std::uint32_t, 3>;
using Triangles = std::vector<Triangle>;

constexpr float units = 4096;  // grid units per unit of the surfaces

ViewDependenceTree tree_of(const SurfaceMesh& mesh) {
  std::vector<Vec3f> positions;
  for (const Vec3d& p : mesh.positions)
    positions.push_back({std::round(static_cast<float>(p.x) * units),
                         std::round(static_cast<float>(p.y) * units),
                         std::round(static_cast<float>(p.z) * units)});
  return baselines::build_view_dependence_tree(positions, mesh.triangles);
}

ErrorScale seen_from(Vec3d eye) {
  View view;
  view.eye = eye * double{units};
  view.target = {0, 0, 0};
  view.up = {0.1, 1, 0.2};
  return ErrorScale::perspective(Grid{}, view);
}

/// Once around, in and out.
Vec3d eye_at(int frame) {
  const double a = frame * 0.23, r = 1.2 + std::abs(std::fmod(frame * 0.17, 4.0) - 2);
  return {r * std::cos(a), 0.4 * r * std::sin(a * 0.7), r * std::sin(a)};
}

Triangle turned(Triangle t) {
  std::rotate(t.begin(), std::min_element(t.begin(), t.end()), t.end());
  return t;
}

Triangles sorted(std::span<const Triangle> list) {
  Triangles out;
  for (const Triangle& t : list) out.push_back(turned(t));
  std::sort(out.begin(), out.end());
  return out;
}

/// V - E + F of the closed manifold that the triangles are; -1000 if they are none.
int euler_characteristic(std::span<const Triangle> triangles) {
  std::map<std::pair<std::uint32_t, std::uint32_t>, int> half_edges;
  std::map<std::uint32_t, std::map<std::uint32_t, std::uint32_t>> links;  // around each vertex
  for (const Triangle& t : triangles)
    for (std::size_t k = 0; k < 3; ++k) {
      const std::uint32_t a = t[k], b = t[(k + 1) % 3], c = t[(k + 2) % 3];
      if (a == b || ++half_edges[{a, b}] > 1) return -1000;
      links[a][b] = c;
    }
  for (const auto& [e, count] : half_edges)
    if (!half_edges.contains({e.second, e.first})) return -1000;
  for (const auto& [v, link] : links) {
    std::size_t steps = 0;
    std::uint32_t at = link.begin()->first;
    do at = link.at(at), ++steps;
    while (at != link.begin()->first && steps <= link.size());
    if (steps != link.size()) return -1000;  // two fans at one vertex
  }
  return static_cast<int>(links.size()) - static_cast<int>(half_edges.size() / 2) +
         static_cast<int>(triangles.size());
}

struct Closed {
  const char* name;
  SurfaceMesh mesh;
  int characteristic;
};

std::vector<Closed> closed_surfaces() {
  return {
      {"sphere", bumpy_sphere(20), 2}, {"torus", bumpy_torus(60, 30), 0}, {"tetrahedron", tetrahedron(), 2}};
}

TEST(ViewDependenceTree, is_a_binary_tree_numbered_by_creation) {
  const ViewDependenceTree tree = tree_of(bumpy_sphere(20));
  ASSERT_EQ(tree.parent.size(), tree.leaves + tree.internal_nodes());
  std::size_t roots = 0;
  for (NodeId n = 0; n < tree.parent.size(); ++n) {
    roots += tree.parent[n] == no_node;
    if (tree.is_leaf(n)) continue;
    EXPECT_EQ(tree.parent[tree.node(n).left], n);
    EXPECT_EQ(tree.parent[tree.node(n).right], n);
    EXPECT_LT(tree.node(n).left, n);
    EXPECT_LT(tree.node(n).right, n);
    EXPECT_EQ(tree.vertex_of(n), tree.vertex_of(tree.node(n).left));
    EXPECT_EQ(tree.removed(n).size(), 2u);
  }
  EXPECT_LE(roots, 12u);
}

TEST(ViewDependenceTree, errors_and_balls_grow_up_the_tree) {
  const ViewDependenceTree tree = tree_of(bumpy_torus(60, 30));
  for (NodeId n = tree.leaves; n < tree.parent.size(); ++n) {
    const NodeId p = tree.parent[n];
    if (p == no_node) continue;
    EXPECT_GE(tree.node(p).error, tree.node(n).error);
    const float apart = length(tree.positions[tree.vertex_of(p)] - tree.positions[tree.vertex_of(n)]);
    EXPECT_GE(tree.node(p).radius * (1 + 1e-5f), tree.node(n).radius + apart);
  }
}

TEST(ViewDependenceTree, memory_is_what_is_stated) {
  const ViewDependenceTree tree = tree_of(bumpy_sphere(10));
  EXPECT_EQ(tree.bytes(), 4 * tree.parent.size() + 28 * tree.internal.size() + 4 * tree.corners.size());
}

TEST(VdtCut, full_refinement_gives_the_original) {
  for (const NamedSurface& surface : surfaces()) {
    const SurfaceMesh mesh = surface.make();
    const ViewDependenceTree tree = tree_of(mesh);
    VdtCut cut(tree);
    EXPECT_LE(cut.drawing_list().size(), mesh.triangles.size());
    cut.refine_fully();
    EXPECT_EQ(sorted(cut.drawing_list()), sorted(mesh.triangles)) << surface.name;
  }
}

TEST(VdtCut, closed_input_gives_closed_manifolds) {
  for (const Closed& surface : closed_surfaces()) {
    const ViewDependenceTree tree = tree_of(surface.mesh);
    VdtCut cut(tree);
    EXPECT_EQ(euler_characteristic(cut.drawing_list()), surface.characteristic) << surface.name;
    for (int frame = 0; frame < 120; ++frame) {
      cut.adapt(seen_from(eye_at(frame)), frame % 3 + 1);
      ASSERT_EQ(euler_characteristic(cut.drawing_list()), surface.characteristic) << surface.name << frame;
    }
  }
}

TEST(VdtCut, no_triangle_without_three_corners_on_open_input) {
  const ViewDependenceTree tree = tree_of(wavy_patch(40));
  VdtCut cut(tree);
  for (int frame = 0; frame < 60; ++frame) {
    cut.adapt(seen_from(eye_at(frame)), 1);
    std::set<std::pair<std::uint32_t, std::uint32_t>> half_edges;
    for (const Triangle& t : cut.drawing_list())
      for (std::size_t k = 0; k < 3; ++k) {
        ASSERT_NE(t[k], t[(k + 1) % 3]);
        ASSERT_TRUE(half_edges.insert({t[k], t[(k + 1) % 3]}).second);
      }
  }
}

TEST(VdtCut, no_active_node_has_a_larger_sse_than_tau) {
  const ViewDependenceTree tree = tree_of(bumpy_sphere(28));
  VdtCut cut(tree);
  std::uint32_t forced = 0, collapses = 0;
  for (int frame = 0; frame < 120; ++frame) {
    const ErrorScale scale = seen_from(eye_at(frame));
    const auto report = cut.adapt(scale, 1);
    forced += report.forced_splits;
    collapses += report.collapses;
    for (const NodeId n : cut.active_nodes()) ASSERT_LE(cut.sse(scale, n), 1 + 1e-9) << frame;
  }
  EXPECT_GT(forced, 0u);  // or dependencies were not tested
  EXPECT_GT(collapses, 0u);
}

/// A camera that stands still ends at a cut that nothing can be taken from.
TEST(VdtCut, comes_to_rest_where_no_collapse_is_legal) {
  const ViewDependenceTree tree = tree_of(bumpy_sphere(28));
  VdtCut cut(tree);
  cut.refine_fully();
  const ErrorScale scale = seen_from(eye_at(5));
  baselines::VdtReport report;
  int calls = 0;
  do report = cut.adapt(scale, 2);
  while (report.splits + report.collapses > 0 && ++calls < 100);
  EXPECT_LT(calls, 100);
  EXPECT_LT(report.triangles, tree.triangles.size() / 2);
  for (const NodeId n : cut.active_nodes()) {
    const NodeId p = tree.parent[n];
    EXPECT_FALSE(p != no_node && cut.sse(scale, p) <= 2 && cut.may_collapse(p)) << p;
  }
}

TEST(VdtCut, active_nodes_are_a_cut_of_the_tree) {
  const ViewDependenceTree tree = tree_of(bumpy_torus(60, 30));
  VdtCut cut(tree);
  for (int frame = 0; frame < 30; ++frame) cut.adapt(seen_from(eye_at(frame)), 1);
  std::vector<int> above(tree.leaves, 0);  // active nodes on the way from a leaf to its root
  for (std::uint32_t v = 0; v < tree.leaves; ++v)
    for (NodeId n = v; n != no_node; n = tree.parent[n]) above[v] += cut.is_active(n);
  EXPECT_EQ(std::count(above.begin(), above.end(), 1), tree.leaves);
}

}  // namespace
}  // namespace cuesta::test
