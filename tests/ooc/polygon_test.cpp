#include "ooc/polygon.h"

#include <gtest/gtest.h>

#include <limits>
#include <numbers>

namespace cuesta {
namespace {

double area_along(const std::vector<Vec3d>& corners, std::array<std::uint32_t, 3> t, Vec3d axis) {
  return 0.5 * dot(axis, cross(corners[t[1]] - corners[t[0]], corners[t[2]] - corners[t[0]]));
}

/// All triangles turn the same way as the polygon, and their areas add up to its area: no overlap, no gap.
void expect_exact_cover(const std::vector<Vec3d>& corners, double area, Vec3d axis) {
  PolygonTriangulator triangulator;
  const auto triangles = triangulator.triangulate(corners);
  ASSERT_EQ(triangles.size(), corners.size() - 2);
  double sum = 0;
  for (const auto& t : triangles) {
    EXPECT_GE(area_along(corners, t, axis), -1e-12);
    sum += area_along(corners, t, axis);
  }
  EXPECT_NEAR(sum, area, 1e-9 * std::abs(area) + 1e-12);
}

TEST(Polygon, ConvexSquare) {
  expect_exact_cover({{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}}, 1, {0, 0, 1});
}

// 3      The dent at 2 must not be cut across, wherever the list starts.
// |\.
// | 2
// |   `.
// 0-----1
TEST(Polygon, ConcaveQuadFromEveryStart) {
  const std::vector<Vec3d> dart{{0, 0, 5}, {4, 0, 5}, {1, 1, 5}, {0, 4, 5}};
  for (std::size_t start = 0; start < 4; ++start) {
    std::vector<Vec3d> turned;
    for (std::size_t i = 0; i < 4; ++i) turned.push_back(dart[(start + i) % 4]);
    expect_exact_cover(turned, 4, {0, 0, 1});
  }
}

TEST(Polygon, ClockwiseSeenFromAboveStaysClockwise) {
  expect_exact_cover({{0, 0, 0}, {0, 4, 0}, {1, 1, 0}, {4, 0, 0}}, 4, {0, 0, -1});
}

TEST(Polygon, StarWithManyReflexCornersFarFromTheOrigin) {
  std::vector<Vec3d> star;
  double area = 0;
  const int points = 50;
  for (int i = 0; i < 2 * points; ++i) {
    const double angle = std::numbers::pi * i / points;
    const double radius = i % 2 == 0 ? 10 : 3;
    star.push_back({500000 + radius * std::cos(angle), 7, -4e6 - radius * std::sin(angle)});
  }
  area = 2 * points * 0.5 * 10 * 3 * std::sin(std::numbers::pi / points);
  expect_exact_cover(star, area, {0, 1, 0});
}

// A square with a square hole, joined by a slit: corners 0 and 4 are visited twice.
TEST(Polygon, KeyholeAroundAHole) {
  expect_exact_cover({{0, 0, 0},
                      {4, 0, 0},
                      {4, 4, 0},
                      {0, 4, 0},
                      {0, 0, 0},
                      {1, 1, 0},
                      {1, 3, 0},
                      {3, 3, 0},
                      {3, 1, 0},
                      {1, 1, 0}},
                     12, {0, 0, 1});
}

TEST(Polygon, WithoutAreaOrNotFiniteIsAFan) {
  PolygonTriangulator triangulator;
  const double nan = std::numeric_limits<double>::quiet_NaN();
  for (const std::vector<Vec3d>& corners :
       {std::vector<Vec3d>{{0, 0, 0}, {1, 0, 0}, {2, 0, 0}, {3, 0, 0}}, std::vector<Vec3d>(5),
        std::vector<Vec3d>{{0, 0, 0}, {1, 0, nan}, {1, 1, 0}, {0, 1, 0}},
        std::vector<Vec3d>{{0, 0, 0}, {1e308, 0, 0}, {1e308, 1e308, 0}, {-1e308, 1e308, 0}}}) {
    const auto triangles = triangulator.triangulate(corners);
    ASSERT_EQ(triangles.size(), corners.size() - 2);
    EXPECT_EQ(triangles[0], (std::array<std::uint32_t, 3>{0, 1, 2}));
  }
}

TEST(Polygon, CrossingItselfStillGivesTheRightNumber) {
  PolygonTriangulator triangulator;
  const std::vector<Vec3d> bow_tie{{0, 0, 0}, {4, 4, 0}, {4, 0, 0}, {0, 5, 0}, {-1, 2, 0}};
  EXPECT_EQ(triangulator.triangulate(bow_tie).size(), 3u);
}

/// A comb is the worst case of clipping; the bound on tests keeps it from hanging.
TEST(Polygon, HugeZigzagEndsSoon) {
  std::vector<Vec3d> comb;
  const int teeth = 100'000;
  for (int i = 0; i < teeth; ++i) comb.push_back({static_cast<double>(i), i % 2 == 0 ? 0.0 : 1000.0, 0});
  comb.push_back({static_cast<double>(teeth), -1, 0});
  comb.push_back({-1, -1, 0});
  PolygonTriangulator triangulator;
  EXPECT_EQ(triangulator.triangulate(comb).size(), comb.size() - 2);
}

}  // namespace
}  // namespace cuesta
