/// Parts of scenes, cleaned: what is dropped, and normals that are broken at sharp edges.

#include "ooc/clean_part.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>
#include <set>

#include "ooc/crease_normals.h"

namespace cuesta {
namespace {

/// Eight vertices, twelve triangles, outside is outside.
SurfaceMesh cube() {
  SurfaceMesh mesh;
  for (int i = 0; i < 8; ++i)
    mesh.positions.push_back({double(i & 1), double(i >> 1 & 1), double(i >> 2 & 1)});
  mesh.triangles = {{0, 2, 1}, {1, 2, 3}, {4, 5, 6}, {5, 7, 6}, {0, 1, 4}, {1, 5, 4},
                    {2, 6, 3}, {3, 6, 7}, {0, 4, 2}, {2, 4, 6}, {1, 3, 5}, {3, 7, 5}};
  return mesh;
}

/// The side of an upright prism, whose vertices are shared.
SurfaceMesh prism(std::uint32_t sides) {
  SurfaceMesh mesh;
  for (std::uint32_t i = 0; i < sides; ++i) {
    const double a = 2 * std::numbers::pi * i / sides;
    mesh.positions.push_back({std::cos(a), std::sin(a), 0});
    mesh.positions.push_back({std::cos(a), std::sin(a), 1});
    const std::uint32_t here = 2 * i, next = 2 * ((i + 1) % sides);
    mesh.triangles.push_back({here, next, next + 1});
    mesh.triangles.push_back({here, next + 1, here + 1});
  }
  return mesh;
}

TEST(CleanPart, CubesKeepTheirEdges) {
  const auto clean = clean_part(cube(), 0, true);
  ASSERT_TRUE(clean) << clean.error().text();
  EXPECT_EQ(clean->mesh.triangles.size(), 12u);
  EXPECT_EQ(clean->mesh.positions.size(), 24u);  // three normals at each corner
  for (const auto& t : clean->mesh.triangles) {
    const auto& p = clean->mesh.positions;
    const Vec3d n = normalized(cross(p[t[1]] - p[t[0]], p[t[2]] - p[t[0]]));
    for (const std::uint32_t v : t) EXPECT_NEAR(dot(vec_cast<double>(clean->mesh.normals[v]), n), 1, 1e-6);
  }
}

TEST(CleanPart, PrismsOfManySidesAreRound) {
  const auto round = clean_part(prism(16), 0, true);
  ASSERT_TRUE(round);
  EXPECT_EQ(round->mesh.positions.size(), 32u);
  for (std::size_t v = 0; v < 32; ++v) {
    const Vec3d p = round->mesh.positions[v];
    EXPECT_NEAR(dot(vec_cast<double>(round->mesh.normals[v]), normalized(Vec3d{p.x, p.y, 0})), 1, 1e-3);
  }
  EXPECT_EQ(clean_part(prism(8), 0, true)->mesh.positions.size(), 32u);  // 45° at each: two normals
}

TEST(CleanPart, NormalsThatAreThereStay) {
  SurfaceMesh mesh = cube();
  mesh.normals.assign(8, Vec3f{0, 0, 1});
  mesh.normals[3] = {};
  const auto clean = clean_part(mesh, 0, true);
  ASSERT_TRUE(clean);
  EXPECT_EQ(clean->mesh.positions.size(), 10u);  // three of vertex 3
  EXPECT_EQ(clean->mesh.normals[0], (Vec3f{0, 0, 1}));
  EXPECT_TRUE(clean_part(cube(), 0, false)->mesh.normals.empty());
}

TEST(CleanPart, ImpossibleFacesAreDroppedAndCounted) {
  SurfaceMesh mesh = cube();
  mesh.positions.push_back({0, 0, 0});  // 8: where 0 is
  mesh.positions.push_back({std::numeric_limits<double>::quiet_NaN(), 0, 0});
  mesh.positions.push_back({1e30, 0, 0});  // 10: unused
  mesh.triangles.push_back({8, 1, 2});     // a copy of the first, the other way round
  mesh.triangles.push_back({0, 8, 1});     // without area
  mesh.triangles.push_back({0, 1, 9});
  const auto clean = clean_part(mesh, 0, true);
  ASSERT_TRUE(clean) << clean.error().text();
  EXPECT_EQ(clean->mesh.triangles.size(), 12u);
  EXPECT_EQ(clean->report.faces_duplicate, 1u);
  EXPECT_EQ(clean->report.faces_degenerate, 1u);
  EXPECT_EQ(clean->report.faces_nonfinite, 1u);
  EXPECT_EQ(clean->report.nonfinite_vertices, 1u);
  EXPECT_EQ(clean->report.vertices_unused, 2u);
  EXPECT_LE(clean->snap_error, clean->grid.snap_error());
}

TEST(CleanPart, NothingLeftIsNoError) {
  SurfaceMesh mesh;
  mesh.positions = {{0, 0, 0}, {std::numeric_limits<double>::infinity(), 0, 0}, {0, 1, 0}};
  mesh.triangles = {{0, 1, 2}};
  const auto clean = clean_part(mesh, 0, true);
  ASSERT_TRUE(clean);
  EXPECT_TRUE(clean->mesh.triangles.empty());
  EXPECT_TRUE(clean_part({}, 0, true)->mesh.triangles.empty());
}

TEST(CleanPart, ThreeSheetsAtAnEdgeAreHandled) {
  SurfaceMesh mesh;
  mesh.positions = {{0, 0, 0}, {0, 0, 1}, {1, 0, 0}, {-1, 0, 0}, {0, 1, 0}};
  mesh.triangles = {{0, 1, 2}, {1, 0, 3}, {0, 1, 4}};
  const auto clean = clean_part(mesh, 0, true);
  ASSERT_TRUE(clean);
  EXPECT_EQ(clean->mesh.triangles.size(), 3u);
  for (const Vec3f& n : clean->mesh.normals) EXPECT_NEAR(length(n), 1, 1e-6);
}

}  // namespace
}  // namespace cuesta
