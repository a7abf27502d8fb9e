#include "apps/measure/triangle_tree.h"

#include <gtest/gtest.h>

#include "measure_shapes.h"

namespace cuesta::measure {
namespace {

/// Distance by a different road: the projection if it falls inside all edges, else the nearest of three
/// segments.
double plain_distance(Vec3d p, Vec3d a, Vec3d b, Vec3d c) {
  const auto to_segment = [p](Vec3d s, Vec3d e) {
    const double l = dot(e - s, e - s);
    const double t = l > 0 ? std::clamp(dot(p - s, e - s) / l, 0.0, 1.0) : 0.0;
    return length(p - (s + (e - s) * t));
  };
  const double edges = std::min({to_segment(a, b), to_segment(b, c), to_segment(c, a)});
  const Vec3d n = cross(b - a, c - a);
  if (length(n) < 1e-9 * length(b - a) * length(c - a) || length(n) == 0) return edges;
  const Vec3d q = p - n * (dot(p - a, n) / dot(n, n));
  const auto left_of = [&](Vec3d s, Vec3d e) { return dot(cross(e - s, q - s), n) >= 0; };
  return left_of(a, b) && left_of(b, c) && left_of(c, a) ? std::min(edges, length(p - q)) : edges;
}

double brute_force(const SurfaceMesh& mesh, Vec3d p) {
  double best = std::numeric_limits<double>::infinity();
  for (const auto& t : mesh.triangles) {
    best =
        std::min(best, plain_distance(p, mesh.positions[t[0]], mesh.positions[t[1]], mesh.positions[t[2]]));
  }
  return best;
}

void expect_equal_to_brute_force(const SurfaceMesh& mesh, Vec3d centre, std::mt19937& bits) {
  const TriangleTree tree(mesh.positions, mesh.triangles);
  std::uniform_real_distribution<double> unit(-1, 1);
  std::uint32_t hint = no_triangle;
  for (int i = 0; i < 300; ++i) {
    const double range = i % 10 == 0 ? 1000 : 1.5;
    const Vec3d p = centre + Vec3d{unit(bits), unit(bits), unit(bits)} * range;
    const NearestPoint found = tree.nearest(p);
    const double tolerance = 1e-12 * (length(centre) + range);
    ASSERT_NEAR(std::sqrt(found.distance_sq), brute_force(mesh, p), tolerance);
    ASSERT_NEAR(length(p - found.point), std::sqrt(found.distance_sq), 1e-9 * (length(centre) + 1));
    EXPECT_EQ(tree.nearest(p, hint).distance_sq, found.distance_sq);
    hint = found.slot;
  }
}

TEST(TriangleTree, EqualsBruteForceOnRandomSoups) {
  for (const std::uint32_t seed : {1u, 2u, 3u}) {
    for (const std::uint32_t count : {1u, 2u, 3u, 4u, 5u, 17u, 100u, 1000u}) {
      SCOPED_TRACE(testing::Message() << "seed " << seed << ", " << count << " triangles");
      std::mt19937 bits(seed * 7919 + count);
      expect_equal_to_brute_force(test::random_soup(seed, count), {}, bits);
      const Vec3d far{4e6, -5e6, 1e6};
      expect_equal_to_brute_force(test::random_soup(seed, count, far), far, bits);
    }
  }
}

TEST(TriangleTree, ParallelBuildGivesTheSameAnswers) {
  const SurfaceMesh mesh = test::square(150, 0.25);
  const TriangleTree tree(mesh.positions, mesh.triangles);
  std::mt19937 bits(5);
  std::uniform_real_distribution<double> unit(0, 1);
  for (int i = 0; i < 1000; ++i) {
    const Vec3d p{unit(bits), unit(bits), unit(bits)};
    EXPECT_NEAR(std::sqrt(tree.nearest(p).distance_sq), std::abs(p.z - 0.25), 1e-12);
  }
}

TEST(TriangleTree, BoundHidesWhatIsFarther) {
  const SurfaceMesh mesh = test::square(4, 0);
  const TriangleTree tree(mesh.positions, mesh.triangles);
  const NearestPoint outside = tree.nearest({0.5, 0.5, 2}, no_triangle, 3.9);
  EXPECT_EQ(outside.triangle, no_triangle);
  EXPECT_EQ(outside.distance_sq, 3.9);
  EXPECT_NE(tree.nearest({0.5, 0.5, 2}, no_triangle, 4.1).triangle, no_triangle);
}

TEST(TriangleTree, EmptyAndNotFinite) {
  const TriangleTree none(std::span<const Vec3d>{}, {});
  EXPECT_TRUE(none.empty());
  EXPECT_EQ(none.nearest({1, 2, 3}).triangle, no_triangle);
  SurfaceMesh mesh = test::square(1, 0);
  mesh.positions[3].z = std::nan("");
  EXPECT_EQ(TriangleTree(mesh.positions, mesh.triangles).triangles_left_out(), 2u);
}

TEST(SquaredDistance, EveryRegionOfATriangle) {
  const Vec3d a{0, 0, 0}, ab{4, 0, 0}, ac{0, 4, 0};
  Vec3d q;
  EXPECT_DOUBLE_EQ(squared_distance({1, 1, 3}, a, ab, ac, &q), 9);     // inside
  EXPECT_DOUBLE_EQ(squared_distance({-3, -4, 0}, a, ab, ac, &q), 25);  // corner a
  EXPECT_DOUBLE_EQ(squared_distance({7, -4, 0}, a, ab, ac, &q), 25);   // corner b
  EXPECT_DOUBLE_EQ(squared_distance({0, 9, 0}, a, ab, ac, &q), 25);    // corner c
  EXPECT_DOUBLE_EQ(squared_distance({2, -2, 0}, a, ab, ac, &q), 4);    // edge ab
  EXPECT_DOUBLE_EQ(squared_distance({-2, 2, 0}, a, ab, ac, &q), 4);    // edge ac
  EXPECT_DOUBLE_EQ(squared_distance({4, 4, 0}, a, ab, ac, &q), 8);     // edge bc
  EXPECT_EQ(q, (Vec3d{2, 2, 0}));
  EXPECT_DOUBLE_EQ(squared_distance({2, 3, 0}, a, ab, ab * 0.5, &q), 9);  // a segment
  EXPECT_DOUBLE_EQ(squared_distance({3, 4, 0}, a, {}, {}, &q), 25);       // a point
}

}  // namespace
}  // namespace cuesta::measure
