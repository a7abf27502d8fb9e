/// A progressive mesh and multiresolution triangle strips draw exactly the substituted mesh: a baseline that
/// cheats or breaks is worth nothing.

#include <gtest/gtest.h>

#include "hierarchy/build_strips.h"
#include "ooc/mesh_reader.h"
#include "tests/hierarchy/surfaces.h"
#include "tests/hierarchy/totally_ordered.h"
#include "tests/shared_data.h"
#include "tools/baselines/mts.h"
#include "tools/baselines/progressive_mesh.h"
#include "tools/bench/total_order.h"

namespace cuesta::test {
namespace {

using baselines::Mts;
using baselines::ProgressiveMesh;

std::vector<Triangle> drawn(const ProgressiveMesh& mesh) {
  return sorted(mesh.triangles());
}
std::vector<Triangle> drawn(const Mts& mesh) {
  std::vector<std::uint32_t> indices(mesh.index_bound());
  return drawn_by(std::span(indices).first(mesh.write_indices(indices)));
}

/// Down and up one by one, and by leaps.
template <class Mesh>
void expect_brute_force(Mesh& mesh, const TotallyOrdered& ordered, std::uint32_t base) {
  const auto expect_at = [&](std::uint32_t r) {
    mesh.set_resolution(r);
    ASSERT_EQ(drawn(mesh), brute_force(ordered, r)) << "resolution " << r;
  };
  for (std::uint32_t r = ordered.full(); r >= base; --r) expect_at(r);
  for (std::uint32_t r = base; r <= ordered.full(); ++r) expect_at(r);
  std::mt19937 random(7);
  for (int i = 0; i < 50; ++i)
    expect_at(base + static_cast<std::uint32_t>(random()) % (ordered.full() - base + 1));
}

/// bumpy_sphere without the triangles of one octant: a border.
SurfaceMesh open_surface() {
  SurfaceMesh surface = bumpy_sphere(6);
  std::erase_if(surface.triangles, [&](const Triangle& t) {
    return std::all_of(t.begin(), t.end(), [&](std::uint32_t v) {
      const Vec3d& p = surface.positions[v];
      return p.x > -1e-9 && p.y > -1e-9 && p.z > -1e-9;
    });
  });
  return surface;
}

TEST(ProgressiveMesh, triangles_are_those_of_the_substituted_mesh) {
  for (const SurfaceMesh& surface : {bumpy_sphere(6), bumpy_torus(14, 9), open_surface()}) {
    const TotallyOrdered ordered = collapse_order(surface, 3);
    ProgressiveMesh mesh(ordered.triangles, ordered.substitute, ordered.base);
    EXPECT_EQ(mesh.base_resolution(), ordered.base) << "every collapse of a manifold is one of its";
    EXPECT_LT(ordered.base, ordered.full() / 4);
    expect_brute_force(mesh, ordered, mesh.base_resolution());
  }
}

TEST(ProgressiveMesh, ends_before_what_is_no_collapse) {
  const SurfaceMesh surface = bumpy_sphere(4);
  TotallyOrdered ordered = collapse_order(surface, 3);
  const std::uint32_t odd = ordered.full() * 3 / 4;
  ordered.substitute[odd] = 0;  // far away
  ProgressiveMesh mesh(ordered.triangles, ordered.substitute, ordered.base);
  EXPECT_EQ(mesh.base_resolution(), odd + 1);
  expect_brute_force(mesh, ordered, mesh.base_resolution());
}

TEST(ProgressiveMesh, bytes_are_24_a_triangle_and_8_a_split) {
  const TotallyOrdered ordered = collapse_order(bumpy_sphere(6), 3);
  const ProgressiveMesh mesh(ordered.triangles, ordered.substitute, ordered.base);
  EXPECT_EQ(mesh.bytes(), ordered.triangles.size() * 24 + (ordered.full() - ordered.base) * 8);
}

TEST(Mts, triangles_are_those_of_the_substituted_mesh) {
  for (const SurfaceMesh& surface : {bumpy_sphere(6), bumpy_torus(14, 9), open_surface()}) {
    const TotallyOrdered ordered = collapse_order(surface, 3);
    Mts mesh(ordered.triangles, ordered.substitute, ordered.base, 16);
    expect_brute_force(mesh, ordered, ordered.base);
  }
}

TEST(Mts, any_substitutes_will_do) {
  const SurfaceMesh surface = bumpy_sphere(5);
  for (std::uint32_t seed = 1; seed <= 5; ++seed) {
    SCOPED_TRACE(seed);
    const TotallyOrdered ordered =
        random_order(surface.triangles, static_cast<std::uint32_t>(surface.positions.size()), 1, seed);
    Mts mesh(ordered.triangles, ordered.substitute, 1, 64);
    expect_brute_force(mesh, ordered, 1);
  }
}

TEST(Mts, only_strips_that_change_are_walked) {
  const TotallyOrdered ordered = collapse_order(bumpy_sphere(20), 3);
  Mts mesh(ordered.triangles, ordered.substitute, ordered.base, 16);
  EXPECT_EQ(mesh.set_resolution(ordered.full()), 0u);
  const std::uint64_t one_step = mesh.set_resolution(ordered.full() - 1);
  EXPECT_GT(one_step, 0u);
  EXPECT_LT(one_step, mesh.index_bound() / 8);
  EXPECT_EQ(mesh.set_resolution(ordered.full() - 1), 0u);
}

/// What the benchmark compares, on a scan that has vertices where two sheets meet.
TEST(StripBaselines, all_draw_the_same_of_a_scan) {
  CUESTA_NEED_SHARED(path, "mesh/cow.obj");
  const auto mesh = load_mesh(path, std::uint64_t{1} << 30);
  ASSERT_TRUE(mesh);
  const bench::TotalOrder order = bench::order_by_quadrics(*mesh);
  const TotallyOrdered ordered{order.triangles, order.substitute, order.base};
  EXPECT_LT(ordered.base, ordered.full() / 50);
  ProgressiveMesh pm(ordered.triangles, ordered.substitute, ordered.base);
  Mts mts(ordered.triangles, ordered.substitute, ordered.base, 32);
  StripMesh strips = build_strips(ordered.triangles, ordered.substitute, ordered.base);
  EXPECT_EQ(pm.base_resolution(), ordered.base);
  std::vector<std::uint32_t> indices(strips.index_bound());
  for (std::uint32_t r = ordered.full(); r > ordered.base; r -= std::min(r - ordered.base, 97u)) {
    const auto expected = brute_force(ordered, r);
    pm.set_resolution(r);
    mts.set_resolution(r);
    strips.set_resolution(r);
    EXPECT_EQ(drawn(pm), expected);
    EXPECT_EQ(drawn(mts), expected);
    EXPECT_EQ(drawn_by(std::span(indices).first(strips.write_indices(indices))), expected);
  }
}

}  // namespace
}  // namespace cuesta::test
