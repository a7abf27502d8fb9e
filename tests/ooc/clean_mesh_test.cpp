// Hand-computable meshes through clean_mesh: every count in the report is asserted, and every result is
// checked.

#include <gtest/gtest.h>

#include <algorithm>
#include <limits>
#include <set>

#include "tests/ooc/check_grid_mesh.h"
#include "tests/ooc/grid_mesh.h"
#include "tests/ooc/small_meshes.h"

namespace cuesta {
namespace {

using namespace test;

struct Cleaned {
  GridMesh mesh;
  CleanReport report;
};

Cleaned clean(SurfaceMesh mesh, CleanOptions options = {}) {
  Cleaned out;
  Result<GridMesh> result = clean_mesh(std::move(mesh), options, out.report);
  EXPECT_TRUE(result.has_value()) << (result ? "" : result.error().text());
  if (result) out.mesh = std::move(*result);
  EXPECT_EQ(find_violation(out.mesh), "");
  return out;
}

std::size_t groups(const GridMesh& mesh) {
  std::size_t n = 0;
  for (std::size_t v = 0; v < mesh.wedge_group.size(); ++v) n += mesh.wedge_group[v] == v;
  return n;
}

/// Edges between groups, and how many of them have one triangle.
struct Edges {
  std::size_t all = 0, border = 0;
};
Edges edges(const GridMesh& mesh) {
  std::multiset<std::pair<std::uint32_t, std::uint32_t>> seen;
  for (const auto& t : mesh.triangles)
    for (std::size_t k = 0; k < 3; ++k)
      seen.insert(std::minmax(mesh.wedge_group[t[k]], mesh.wedge_group[t[(k + 1) % 3]]));
  Edges out;
  for (auto it = seen.begin(); it != seen.end(); it = seen.upper_bound(*it), ++out.all)
    out.border += seen.count(*it) == 1;
  return out;
}

long euler(const GridMesh& mesh) {
  return static_cast<long>(groups(mesh)) - static_cast<long>(edges(mesh).all) +
         static_cast<long>(mesh.triangles.size());
}

TEST(CleanMesh, TetrahedronIsUnchanged) {
  const auto [mesh, report] = clean(tetrahedron());
  EXPECT_EQ(mesh.positions.size(), 4u);
  EXPECT_EQ(mesh.triangles.size(), 4u);
  EXPECT_EQ(euler(mesh), 2);
  EXPECT_EQ(edges(mesh).border, 0u);
  EXPECT_EQ(report.vertices_welded + report.vertices_split + report.vertices_unused, 0u);
  // Morton order with x lowest is the order of the input here, with steps of median edge / 128.
  for (std::size_t v = 0; v < 4; ++v)
    EXPECT_LE(length(mesh.grid.world(mesh.positions[v]) - tetrahedron().positions[v]),
              mesh.grid.step * 0.8661);
  EXPECT_EQ(mesh.triangles, (Triangles{{0, 1, 3}, {0, 2, 1}, {0, 3, 2}, {1, 2, 3}}));
}

TEST(CleanMesh, DefaultStepIsASixtyFourthOfTheMedianEdge) {
  EXPECT_DOUBLE_EQ(clean(cube()).mesh.grid.step,
                   1.0 / 128);  // 24 sides and 12 diagonals, as triangles see them
}

TEST(CleanMesh, DefaultStepIsAtLeastExtentOver2To21) {
  SurfaceMesh mesh = joined(tetrahedron(), cube());
  for (std::size_t v = 4; v < 12; ++v) mesh.positions[v] = mesh.positions[v] + Vec3d{1e5, 0, 0};
  EXPECT_DOUBLE_EQ(clean(mesh).mesh.grid.step, (1e5 + 1) / (1 << 21));
}

TEST(CleanMesh, OriginIsTheBoxMinimumRoundedDownToTheStep) {
  const auto [mesh, report] = clean(cube({-3.3, 5.1, 0}), {.step = 0.25});
  EXPECT_EQ(mesh.grid.origin, (Vec3d{-3.5, 5.0, 0}));
  EXPECT_EQ(mesh.grid.step, 0.25);
}

TEST(CleanMesh, TooFineAStepForTheExtentIsInvalid) {
  CleanReport report;
  const auto result = clean_mesh(cube(), {.step = 1e-10}, report);
  ASSERT_FALSE(result);
  EXPECT_EQ(result.error().code, ErrorCode::invalid_input);
  EXPECT_FALSE(clean_mesh(cube(), {.step = -1}, report));
  EXPECT_FALSE(clean_mesh(cube(), {.step = std::numeric_limits<double>::quiet_NaN()}, report));
}

TEST(CleanMesh, StepsFinerThan21BitsKeepPositionsApart) {
  // Neighbours along the diagonal differ in the low bits only: the key's high part ties for all of them.
  SurfaceMesh mesh = joined(tetrahedron(), wavy_patch(8));
  for (std::size_t v = 0; v < 4; ++v) mesh.positions[v] = mesh.positions[v] * 1e6 - Vec3d{1e6, 1e6, 1e6};
  const auto [cleaned, report] = clean(mesh, {.step = 1e-3});
  EXPECT_EQ(report.vertices_welded, 0u);
  EXPECT_EQ(cleaned.positions.size(), mesh.positions.size());
}

TEST(CleanMesh, TwoCubesSharingAnEdgeComeApart) {
  //    ┌──┐
  //    │  ├──┐   seen from above: they touch along one vertical edge
  //    └──┤  │
  //       └──┘
  const auto [mesh, report] = clean(joined(cube(), cube({1, 1, 0})));
  EXPECT_EQ(report.vertices_welded, 2u);
  EXPECT_EQ(report.edges_nonmanifold, 1u);
  EXPECT_EQ(report.vertices_split, 2u);
  EXPECT_EQ(groups(mesh), 16u);
  EXPECT_EQ(edges(mesh).border, 0u);
  EXPECT_EQ(euler(mesh), 4);
}

TEST(CleanMesh, TwoConesSharingAnApexComeApart) {
  const auto [mesh, report] = clean(joined(cone(6, -2), cone(5, 2)));
  EXPECT_EQ(report.vertices_welded, 1u);
  EXPECT_EQ(report.vertices_split, 1u);
  EXPECT_EQ(report.edges_nonmanifold, 0u);
  EXPECT_EQ(groups(mesh), 13u);
  EXPECT_EQ(edges(mesh).border, 11u);
}

TEST(CleanMesh, ThreeTrianglesOnOneEdgeAreAllDisconnected) {
  const auto [mesh, report] = clean(
      mesh_of({{0, 0, 0}, {0, 0, 1}, {1, 0, 0}, {-1, 1, 0}, {-1, -1, 0}}, {{0, 1, 2}, {1, 0, 3}, {0, 1, 4}}));
  EXPECT_EQ(report.edges_nonmanifold, 1u);
  EXPECT_EQ(report.vertices_split, 4u);
  EXPECT_EQ(mesh.positions.size(), 9u);
  EXPECT_EQ(edges(mesh).border, 9u);
}

TEST(CleanMesh, AFinOnAClosedSurfaceLeavesItClosed) {
  SurfaceMesh mesh = tetrahedron();
  mesh.positions.push_back({2, -1, -1});
  mesh.triangles.push_back({0, 1, 4});
  const auto [cleaned, report] = clean(mesh);
  EXPECT_EQ(report.edges_nonmanifold, 1u);
  EXPECT_EQ(report.vertices_split, 2u);
  EXPECT_EQ(cleaned.positions.size(), 7u);
  EXPECT_EQ(edges(cleaned).border, 3u);  // of the fin
}

TEST(CleanMesh, MoebiusStripIsCutOnceAcross) {
  constexpr int n = 12;
  SurfaceMesh strip;
  for (int i = 0; i < n; ++i)
    for (const double side : {-0.4, 0.4}) {
      const double a = 6.283185307179586 * i / n;
      const double r = 2 + side * std::cos(a / 2);
      strip.positions.push_back({r * std::cos(a), r * std::sin(a), side * std::sin(a / 2)});
    }
  for (std::uint32_t i = 0; i < n; ++i) {
    const bool last = i == n - 1;  // the far side joins with its ends swapped
    const std::uint32_t a = 2 * i, b = a + 1, c = last ? 1 : a + 2, d = last ? 0 : a + 3;
    strip.triangles.push_back({a, b, c});
    strip.triangles.push_back({b, d, c});
  }
  const auto [mesh, report] = clean(strip);
  EXPECT_EQ(report.edges_nonmanifold, 1u);
  EXPECT_EQ(report.vertices_split, 2u);
  EXPECT_EQ(mesh.triangles.size(), 24u);
  EXPECT_EQ(euler(mesh), 1);  // a disc
}

TEST(CleanMesh, InconsistentWindingIsCutAllRound) {
  SurfaceMesh mesh = cube();
  for (std::size_t i : {0u, 1u}) std::swap(mesh.triangles[i][1], mesh.triangles[i][2]);
  const auto [cleaned, report] = clean(mesh);
  EXPECT_EQ(report.edges_nonmanifold, 4u);
  EXPECT_EQ(report.vertices_split, 4u);
  EXPECT_EQ(edges(cleaned).border, 8u);
  EXPECT_EQ(cleaned.triangles.size(), 12u);
}

TEST(CleanMesh, DuplicateFacesGoBothWaysRound) {
  SurfaceMesh mesh = tetrahedron();
  mesh.triangles.push_back({2, 1, 0});  // the first one turned
  mesh.triangles.push_back({1, 2, 0});  // … and the other way round
  const auto [cleaned, report] = clean(mesh);
  EXPECT_EQ(report.faces_duplicate, 2u);
  EXPECT_EQ(report.edges_nonmanifold, 0u);
  EXPECT_EQ(edges(cleaned).border, 0u);
}

TEST(CleanMesh, OfTwoDuplicatesTheEarlierFaceStays) {
  const auto forward = clean(mesh_of(tetrahedron().positions, {{1, 2, 3}, {3, 2, 1}})).mesh;
  const auto backward = clean(mesh_of(tetrahedron().positions, {{3, 2, 1}, {1, 2, 3}})).mesh;
  ASSERT_EQ(forward.triangles.size(), 1u);
  EXPECT_EQ(forward.triangles[0], (std::array{0u, 1u, 2u}));
  EXPECT_EQ(backward.triangles[0], (std::array{0u, 2u, 1u}));
}

TEST(CleanMesh, ManyDuplicatesOfManyFacesAreFound) {
  SurfaceMesh mesh = cone(40, 1);
  const Triangles faces = mesh.triangles;
  for (const auto& t : faces) mesh.triangles.push_back({t[2], t[1], t[0]});
  EXPECT_EQ(clean(mesh).report.faces_duplicate, 40u);
}

TEST(CleanMesh, DegenerateFacesAreDropped) {
  SurfaceMesh mesh = tetrahedron();
  mesh.positions.push_back({1e-9, 0, 0});  // welds to vertex 0
  mesh.triangles.insert(mesh.triangles.end(), {{1, 1, 2}, {0, 4, 3}, {4, 4, 4}});
  const auto [cleaned, report] = clean(mesh);
  EXPECT_EQ(report.faces_degenerate, 3u);
  EXPECT_EQ(report.vertices_welded, 1u);
  EXPECT_EQ(cleaned.triangles.size(), 4u);
}

TEST(CleanMesh, NonFiniteVerticesTakeTheirFacesAlong) {
  SurfaceMesh mesh = tetrahedron();
  mesh.positions.push_back({0, std::numeric_limits<double>::quiet_NaN(), 0});
  mesh.positions.push_back({std::numeric_limits<double>::infinity(), 0, 0});
  mesh.positions.push_back({1e30, 1e30, 1e30});  // used by a dropped face only: must not stretch the grid
  mesh.triangles.insert(mesh.triangles.begin(), {{0, 1, 4}, {5, 2, 6}});
  const auto [cleaned, report] = clean(mesh);
  EXPECT_EQ(report.nonfinite_vertices, 2u);
  EXPECT_EQ(report.faces_nonfinite, 2u);
  EXPECT_EQ(report.vertices_unused, 1u);
  EXPECT_EQ(cleaned.triangles.size(), 4u);
  EXPECT_LT(cleaned.grid.step, 1);
}

TEST(CleanMesh, SoupWeldsToAClosedCube) {
  const auto [mesh, report] = clean(soup_of(cube()));
  EXPECT_EQ(report.vertices_welded, 36u - 8u);
  EXPECT_EQ(mesh.positions.size(), 8u);
  EXPECT_EQ(edges(mesh).border, 0u);
  EXPECT_EQ(euler(mesh), 2);
}

TEST(CleanMesh, CubeWithFaceNormalsHasEightGroupsOfThreeWedges) {
  const auto [mesh, report] = clean(soup_of(cube(), true));
  EXPECT_EQ(mesh.positions.size(), 24u);
  EXPECT_EQ(report.wedge_groups, 8u);
  EXPECT_EQ(groups(mesh), 8u);
  EXPECT_EQ(report.vertices_split, 0u);
  EXPECT_EQ(edges(mesh).border, 0u);
  for (std::size_t v = 0; v < 24; v += 3) EXPECT_EQ(mesh.wedge_group[v + 2], v);
}

TEST(CleanMesh, SheetsThatComeApartTakeOnlyTheirOwnWedges) {
  SurfaceMesh a = soup_of(cube(), true);
  const SurfaceMesh b =
      soup_of(cube({1, 1, 1}), true);  // one corner in common: three wedges each, all different
  SurfaceMesh both = joined(a, b);
  both.normals = a.normals;
  both.normals.insert(both.normals.end(), b.normals.begin(), b.normals.end());
  const auto [mesh, report] = clean(both);
  EXPECT_EQ(groups(mesh), 16u);
  EXPECT_EQ(mesh.positions.size(), 48u);
  EXPECT_EQ(report.vertices_split, 0u);  // -x and +x faces have different normals: nothing to copy
}

TEST(CleanMesh, UnusedVerticesAreDropped) {
  SurfaceMesh mesh = tetrahedron();
  mesh.positions.insert(mesh.positions.begin(), {9, 9, 9});
  for (auto& t : mesh.triangles) t = {t[0] + 1, t[1] + 1, t[2] + 1};
  const auto [cleaned, report] = clean(mesh);
  EXPECT_EQ(report.vertices_unused, 1u);
  EXPECT_EQ(cleaned.positions.size(), 4u);
}

TEST(CleanMesh, NothingLeftIsInvalidInput) {
  CleanReport report;
  EXPECT_EQ(clean_mesh({}, {}, report).error().code, ErrorCode::invalid_input);
  EXPECT_EQ(clean_mesh(mesh_of({{1, 1, 1}}, {{0, 0, 0}}), {}, report).error().code, ErrorCode::invalid_input);
}

TEST(CleanMesh, AttributesStayWithTheirVertices) {
  SurfaceMesh mesh = cube();
  for (std::uint8_t i = 0; i < 8; ++i) {
    mesh.colours.push_back({i, 0, 0, 255});
    mesh.texcoords.push_back({float(i), 0});
  }
  const GridMesh cleaned = clean(mesh, {.step = 1}).mesh;
  for (std::size_t v = 0; v < 8; ++v) {
    const Vec3i p = cleaned.positions[v];
    EXPECT_EQ(cleaned.colours[v][0], p.x + 2 * p.y + 4 * p.z);
    EXPECT_EQ(cleaned.texcoords[v][0], float(p.x + 2 * p.y + 4 * p.z));
  }
}

TEST(CleanMesh, MakesSmoothNormalsWhenThereAreNone) {
  const GridMesh mesh = clean(joined(cube({7, 7, 7}), cube())).mesh;
  ASSERT_EQ(mesh.normals.size(), 16u);
  for (const Vec3f& n : mesh.normals) EXPECT_NEAR(length(n), 1, 1e-6);
  EXPECT_LT(dot(mesh.normals[0], Vec3f{1, 1, 1}), -1.5f);  // outward at the lowest corner
  EXPECT_TRUE(clean(cube(), {.make_normals = false}).mesh.normals.empty());
}

TEST(CleanMesh, NormalsThatAreZeroAreComputed) {
  SurfaceMesh given = cube();
  given.normals.assign(given.positions.size(), Vec3f{0, 0, 1});
  given.normals.front() = {};
  const GridMesh filled = clean(given).mesh;
  const GridMesh kept = clean(given, {.make_normals = false}).mesh;
  ASSERT_EQ(filled.normals.size(), kept.normals.size());
  std::size_t computed = 0;
  for (std::size_t v = 0; v < kept.normals.size(); ++v) {
    if (kept.normals[v] == Vec3f{}) {
      ++computed;
      EXPECT_NEAR(length(filled.normals[v]), 1, 1e-6);
    } else {
      EXPECT_EQ(filled.normals[v], kept.normals[v]);
    }
  }
  EXPECT_EQ(computed, 1u);
}

TEST(CleanMesh, FarFromZeroStillFits) {
  for (const double at : {1e9, -1e9, 1e15, -1e15, 4e15}) clean(cube({at, at, -at}));
  CleanReport report;
  SurfaceMesh huge = cube();
  for (Vec3d& p : huge.positions) p = p * 3e307 * 5.0 - Vec3d{1e308, 1e308, 1e308};
  EXPECT_FALSE(clean_mesh(joined(huge, cube({-1e308, 0, 0})), {.step = 1}, report));
}

}  // namespace
}  // namespace cuesta
