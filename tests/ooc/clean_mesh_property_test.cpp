// clean_mesh on random triangle soups: whatever comes in, what comes out keeps the promises of grid_mesh.h.
// CUESTA_TEST_SEED replays a run.

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>
#include <limits>
#include <numeric>
#include <optional>
#include <random>
#include <string>

#include "tests/ooc/check_grid_mesh.h"
#include "tests/ooc/grid_mesh.h"
#include "tests/ooc/openmesh_oracle.h"
#include "tests/ooc/small_meshes.h"

namespace cuesta {
namespace {

using namespace test;
using Random = std::mt19937;

std::uint32_t first_seed() {
  const char* text = std::getenv("CUESTA_TEST_SEED");
  return text ? static_cast<std::uint32_t>(std::strtoul(text, nullptr, 10)) : 1;
}

std::uint32_t below(Random& random, std::uint32_t n) {
  return static_cast<std::uint32_t>(random() % n);
}

/// Triangles between points of a small lattice: full of duplicates, fans, bow-ties and edges with many faces.
SurfaceMesh random_soup(Random& random) {
  SurfaceMesh mesh;
  const std::uint32_t side = 2 + below(random, 4), kinds = 1 + below(random, 3);
  const std::uint32_t vertices = 4 + below(random, 120), triangles = 1 + below(random, 200);
  for (std::uint32_t v = 0; v < vertices; ++v) {
    mesh.positions.push_back(
        {double(below(random, side)), double(below(random, side)), double(below(random, 3))});
    if (below(random, 50) == 0) mesh.positions.back().y = std::numeric_limits<double>::quiet_NaN();
    mesh.colours.push_back({static_cast<std::uint8_t>(below(random, kinds)), 0, 0, 255});
  }
  for (std::uint32_t i = 0; i < triangles; ++i)
    mesh.triangles.push_back({below(random, vertices), below(random, vertices), below(random, vertices)});
  return mesh;
}

/// A wavy patch with a few faces turned, doubled, or tied to a far vertex.
SurfaceMesh damaged_patch(Random& random) {
  SurfaceMesh mesh = wavy_patch(4 + static_cast<int>(below(random, 12)));
  for (std::uint32_t i = below(random, 12); i > 0; --i) {
    auto& t = mesh.triangles[below(random, static_cast<std::uint32_t>(mesh.triangles.size()))];
    const std::uint32_t what = below(random, 3);
    if (what == 0) std::swap(t[0], t[1]);
    if (what == 1) t[below(random, 3)] = below(random, static_cast<std::uint32_t>(mesh.positions.size()));
    if (what == 2) mesh.triangles.push_back({t[1], t[2], t[0]});
  }
  return mesh;
}

struct Cleaned {
  GridMesh mesh;
  CleanReport report;
};

/// Nothing, for a soup of which no face is left.
std::optional<Cleaned> clean(SurfaceMesh mesh, CleanOptions options = {}) {
  Cleaned out;
  Result<GridMesh> result = clean_mesh(std::move(mesh), options, out.report);
  if (!result) return std::nullopt;
  out.mesh = std::move(*result);
  return out;
}

SurfaceMesh as_input(const GridMesh& mesh) {
  SurfaceMesh out;
  for (const Vec3i p : mesh.positions) out.positions.push_back(mesh.grid.world(p));
  out.normals = mesh.normals;
  out.colours = mesh.colours;
  out.texcoords = mesh.texcoords;
  out.triangles = mesh.triangles;
  return out;
}

void expect_same(const GridMesh& a, const GridMesh& b) {
  EXPECT_EQ(a.grid.origin, b.grid.origin);
  EXPECT_EQ(a.grid.step, b.grid.step);
  EXPECT_EQ(a.positions, b.positions);
  EXPECT_EQ(a.normals, b.normals);
  EXPECT_EQ(a.colours, b.colours);
  EXPECT_EQ(a.wedge_group, b.wedge_group);
  EXPECT_EQ(a.triangles, b.triangles);
}

/// Calls test(random, soup or patch) a few hundred times, each with a seed that a failure prints.
template <class Test>
void for_random_meshes(Test test) {
  const std::uint32_t seed = first_seed();
  for (std::uint32_t i = 0; i < 150; ++i) {
    SCOPED_TRACE("CUESTA_TEST_SEED=" + std::to_string(seed + i));
    Random random(seed + i);
    const bool soup = below(random, 4) != 0;
    test(random, soup ? random_soup(random) : damaged_patch(random));
    if (testing::Test::HasFailure()) return;
  }
}

TEST(CleanMeshProperty, KeepsTheInvariants) {
  for_random_meshes([](Random&, const SurfaceMesh& mesh) {
    const auto out = clean(mesh);
    EXPECT_EQ(out ? find_violation(out->mesh) : "", "");
  });
}

TEST(CleanMeshProperty, OpenMeshTakesEveryFace) {
  for_random_meshes([](Random&, const SurfaceMesh& mesh) {
    const auto out = clean(mesh);
    EXPECT_EQ(out ? openmesh_complaint(out->mesh) : "", "");
  });
}

TEST(CleanMeshProperty, EveryFaceAndVertexIsAccountedFor) {
  for_random_meshes([](Random&, const SurfaceMesh& mesh) {
    const auto out = clean(mesh);
    if (!out) return;
    const CleanReport& r = out->report;
    EXPECT_EQ(out->mesh.triangles.size() + r.faces_nonfinite + r.faces_degenerate + r.faces_duplicate,
              mesh.triangles.size());
    EXPECT_EQ(out->mesh.positions.size() + r.nonfinite_vertices + r.vertices_welded + r.vertices_unused,
              mesh.positions.size() + r.vertices_split);
  });
}

TEST(CleanMeshProperty, CleaningTwiceDropsNothingMore) {
  for_random_meshes([](Random&, const SurfaceMesh& mesh) {
    const auto once = clean(mesh);
    if (!once) return;
    const auto twice = clean(as_input(once->mesh), {.step = once->mesh.grid.step});
    ASSERT_TRUE(twice);
    EXPECT_EQ(twice->mesh.triangles.size(), once->mesh.triangles.size());
    EXPECT_EQ(twice->report.faces_degenerate + twice->report.faces_duplicate, 0u);
    EXPECT_EQ(twice->mesh.positions.size(), once->mesh.positions.size());
    EXPECT_EQ(twice->mesh.grid.step, once->mesh.grid.step);
  });
}

/// Vertices that coincide after snapping are told apart by their old order; without such ties that order is
/// lost.
TEST(CleanMeshProperty, OrderOfVerticesAndFacesDoesNotMatterWithoutTies) {
  for_random_meshes([](Random& random, SurfaceMesh mesh) {
    mesh = wavy_patch(3 + static_cast<int>(below(random, 20)));
    const auto expected = clean(mesh, {.make_normals = false});
    std::vector<std::uint32_t> place(mesh.positions.size());
    std::iota(place.begin(), place.end(), 0u);
    std::ranges::shuffle(place, random);
    SurfaceMesh shuffled = mesh;
    for (std::size_t v = 0; v < place.size(); ++v) shuffled.positions[place[v]] = mesh.positions[v];
    for (auto& t : shuffled.triangles) t = {place[t[1]], place[t[2]], place[t[0]]};
    std::ranges::shuffle(shuffled.triangles, random);
    const auto found = clean(shuffled, {.step = expected->mesh.grid.step, .make_normals = false});
    ASSERT_TRUE(expected && found);
    expect_same(expected->mesh, found->mesh);
  });
}

TEST(CleanMeshProperty, SoupOfASurfaceIsThatSurface) {
  for_random_meshes([](Random& random, SurfaceMesh mesh) {
    mesh = wavy_patch(3 + static_cast<int>(below(random, 20)));
    const auto expected = clean(mesh), found = clean(soup_of(mesh));
    ASSERT_TRUE(expected && found);
    expect_same(expected->mesh, found->mesh);
  });
}

/// Positions and wedges of each face, in an order that does not depend on how vertices are numbered.
std::vector<std::array<std::array<int, 4>, 3>> faces_of(const GridMesh& mesh) {
  std::vector<std::array<std::array<int, 4>, 3>> faces;
  for (const auto& t : mesh.triangles) {
    std::array<std::array<int, 4>, 3> face;
    for (std::size_t k = 0; k < 3; ++k) {
      const Vec3i p = mesh.positions[t[k]];
      face[k] = {p.x, p.y, p.z, mesh.colours.empty() ? 0 : mesh.colours[t[k]][0]};
    }
    std::ranges::rotate(face, std::ranges::min_element(face));
    faces.push_back(face);
  }
  std::ranges::sort(faces);
  return faces;
}

/// Chunks of a few triangles: most points are shared by several, and all decisions are the same.
TEST(CleanMeshProperty, ChunksDoNotMatter) {
  for_random_meshes([](Random& random, const SurfaceMesh& mesh) {
    const auto whole = clean(mesh);
    const auto chunked = clean(mesh, {.chunk_triangles = 1 + below(random, 30)});
    ASSERT_EQ(whole.has_value(), chunked.has_value());
    if (!whole) return;
    EXPECT_EQ(find_violation(chunked->mesh), "");
    EXPECT_EQ(faces_of(whole->mesh), faces_of(chunked->mesh));
    EXPECT_EQ(whole->mesh.positions.size(), chunked->mesh.positions.size());
    const CleanReport &a = whole->report, &b = chunked->report;
    EXPECT_EQ(a.vertices_welded, b.vertices_welded);
    EXPECT_EQ(a.vertices_split, b.vertices_split);
    EXPECT_EQ(a.vertices_unused, b.vertices_unused);
    EXPECT_EQ(a.edges_nonmanifold, b.edges_nonmanifold);
    EXPECT_EQ(a.faces_duplicate, b.faces_duplicate);
    EXPECT_EQ(a.wedge_groups, b.wedge_groups);
  });
}

/// Triangles that reach over many blocks of vertices are joined as those within one are.
TEST(CleanMeshProperty, BlocksDoNotMatter) {
  for_random_meshes([](Random& random, const SurfaceMesh& mesh) {
    const std::uint32_t chunk = 1 + below(random, 60);
    const auto one = clean(mesh, {.chunk_triangles = chunk});
    const auto many = clean(mesh, {.chunk_triangles = chunk, .block_vertices = 1 + below(random, 40)});
    ASSERT_EQ(one.has_value(), many.has_value());
    if (one) expect_same(one->mesh, many->mesh);
  });
}

/// A checker that finds nothing in damaged meshes would make every test above pass.
TEST(FindViolation, SeesEachKindOfDamage) {
  CleanReport report;
  const GridMesh good = *clean_mesh(wavy_patch(3), {}, report);
  ASSERT_EQ(find_violation(good), "");
  const auto damage = [&](auto change) {
    GridMesh bad = good;
    change(bad);
    return find_violation(bad);
  };
  const auto& t = good.triangles;
  EXPECT_NE(damage([](GridMesh& m) { m.normals.pop_back(); }), "");
  EXPECT_NE(damage([](GridMesh& m) { m.triangles.clear(); }), "");
  EXPECT_NE(damage([](GridMesh& m) { m.grid.step = 0; }), "");
  EXPECT_NE(damage([](GridMesh& m) { m.positions[3].x = -1; }), "");
  EXPECT_NE(damage([](GridMesh& m) { m.wedge_group[3] = 2; }), "");
  EXPECT_NE(damage([](GridMesh& m) { m.wedge_group[3] = 99; }), "");
  EXPECT_NE(damage([](GridMesh& m) { m.triangles[0][1] = 99; }), "");
  EXPECT_NE(damage([](GridMesh& m) { m.triangles[0][1] = m.triangles[0][0]; }), "");
  EXPECT_NE(damage([](GridMesh& m) { std::swap(m.triangles[0], m.triangles[1]); }), "");
  EXPECT_NE(damage([](GridMesh& m) { std::ranges::rotate(m.triangles[0], m.triangles[0].begin() + 1); }), "");
  EXPECT_NE(damage([](GridMesh& m) { std::swap(m.triangles[4][1], m.triangles[4][2]); }), "");
  EXPECT_NE(damage([&](GridMesh& m) { m.triangles.insert(m.triangles.begin(), t[0]); }), "");
  EXPECT_NE(damage([&](GridMesh& m) { m.triangles.insert(m.triangles.begin(), {0, 1, 15}); }), "");
}

TEST(FindViolation, NamesTheBowTie) {
  GridMesh mesh;
  mesh.positions = {{2, 2, 0}, {3, 2, 0}, {2, 3, 0}, {1, 2, 0}, {2, 1, 0}};
  mesh.wedge_group = {0, 1, 2, 3, 4};
  mesh.triangles = {{0, 1, 2}, {0, 3, 4}};
  EXPECT_EQ(find_violation(mesh),
            "the triangles around group 0 are more than one fan: 0 and 1 are not connected");
  mesh.triangles = {{0, 1, 2}, {0, 1, 3}};
  EXPECT_NE(find_violation(mesh).find("not used"), std::string::npos);
  mesh.triangles = {{0, 1, 2}, {0, 1, 3}, {0, 3, 4}};
  EXPECT_EQ(find_violation(mesh),
            "the edge of groups 0 and 1 has a second triangle in the same direction, 1");
  EXPECT_NE(openmesh_complaint(mesh), "");
}

}  // namespace
}  // namespace cuesta
