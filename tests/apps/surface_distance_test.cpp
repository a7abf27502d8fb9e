#include "apps/measure/surface_distance.h"

#include <gtest/gtest.h>
#include <tbb/task_arena.h>

#include "measure_shapes.h"

namespace cuesta::measure {
namespace {

TEST(SurfaceDistance, ParallelSquares) {
  const SurfaceMesh a = test::square(3, 0), b = test::square(7, 0.25);
  const SymmetricDistance d = symmetric_distance(a, b, {.samples = 10'000});
  for (const double value : {d.mean, d.rms, d.max, d.forward.mean, d.backward.max})
    EXPECT_NEAR(value, 0.25, 1e-12);
  EXPECT_EQ(d.forward.samples, 10'000u);
  const double diagonal = bounding_diagonal(a);
  EXPECT_NEAR(diagonal, std::sqrt(2.0), 1e-15);
  EXPECT_NEAR(percent_of(d, diagonal).mean, 25 / std::sqrt(2.0), 1e-9);
  EXPECT_NEAR(percent_of(d.forward, diagonal).max, 25 / std::sqrt(2.0), 1e-9);
}

// A slope over a square: distances are uniform in [0, h'], so every moment is known.
TEST(SurfaceDistance, SlopeHasTheMomentsOfAUniformDistribution) {
  SurfaceMesh slope = test::square(5, 0);
  for (Vec3d& p : slope.positions) p.z = p.x * 0.5;
  const SurfaceMesh ground = test::square(1, 0);
  const DistanceStats d = surface_distance(slope, make_tree(ground), {.samples = 100'000});
  EXPECT_NEAR(d.mean, 0.25, 1e-4);
  EXPECT_NEAR(d.rms, 0.5 / std::sqrt(3.0), 1e-4);
  EXPECT_NEAR(d.max, 0.5, 1e-12);
  EXPECT_DOUBLE_EQ(d.worst.x, 1);
  const VertexDistances v = vertex_distance(slope, make_tree(ground));
  EXPECT_NEAR(v.mean, 0.25, 1e-12);
  EXPECT_NEAR(v.percentiles.p50, 0.2, 1e-12);  // nearest rank: the third of six columns
  EXPECT_NEAR(v.percentiles.max, 0.5, 1e-12);
  EXPECT_NEAR(v.distances[1], 0.1, 1e-12);
}

TEST(SurfaceDistance, SphereAndSmallerSphere) {
  const SymmetricDistance d =
      symmetric_distance(test::sphere(200, 1), test::sphere(200, 0.9), {.samples = 100'000});
  EXPECT_NEAR(d.mean, 0.1, 1e-4);
  EXPECT_NEAR(d.max, 0.1, 3e-4);
}

// Samples must follow area, not triangles: half of the area is one triangle pair at height 1, half is 800 at
// height 0.
TEST(SurfaceDistance, SamplesFollowArea) {
  SurfaceMesh mesh = test::square(20, 0);
  const SurfaceMesh coarse = test::square(1, 1);
  const auto base = static_cast<std::uint32_t>(mesh.positions.size());
  mesh.positions.insert(mesh.positions.end(), coarse.positions.begin(), coarse.positions.end());
  for (const auto& t : coarse.triangles) mesh.triangles.push_back({t[0] + base, t[1] + base, t[2] + base});
  const DistanceStats d = surface_distance(mesh, make_tree(test::square(1, 0)), {.samples = 10'000});
  EXPECT_NEAR(d.mean, 0.5, 1e-3);
  EXPECT_NEAR(d.rms, std::sqrt(0.5), 1e-3);
}

TEST(SurfaceDistance, VerticesCountForTheMaximumOnly) {
  SurfaceMesh spike = test::square(10, 0);
  spike.positions[60].z = 0.5;
  const DistanceStats d = surface_distance(spike, make_tree(test::square(1, 0)), {.samples = 10});
  EXPECT_DOUBLE_EQ(d.max, 0.5);
  EXPECT_LT(d.mean, 0.2);
  EXPECT_EQ(d.samples, 10u);
}

TEST(SurfaceDistance, EmptyInputs) {
  const SurfaceMesh none, some = test::square(2, 0);
  const DistanceStats from_none = surface_distance(none, make_tree(some));
  EXPECT_EQ(from_none.samples, 0u);
  EXPECT_EQ(from_none.max, 0);
  EXPECT_TRUE(std::isinf(surface_distance(some, make_tree(none)).mean));
  EXPECT_TRUE(std::isinf(symmetric_distance(none, some).max));
  EXPECT_EQ(symmetric_distance(none, none).max, 0);
  EXPECT_EQ(bounding_diagonal(none), 0);
  EXPECT_EQ(vertex_distance(none, make_tree(some)).percentiles.count, 0u);
  EXPECT_EQ(percent_of(from_none, 0).mean, 0);
}

TEST(SurfaceDistance, UnusedAndBrokenVerticesDoNotCount) {
  SurfaceMesh mesh = test::square(2, 0);
  mesh.positions.push_back({9, 9, 9});
  mesh.positions.push_back({std::nan(""), 0, 0});
  mesh.triangles.push_back({0, 1, 10});
  const VertexDistances v = vertex_distance(mesh, make_tree(test::square(1, 0)));
  EXPECT_TRUE(std::isnan(v.distances[9]) && std::isnan(v.distances[10]));
  EXPECT_EQ(v.percentiles.count, 9u);
  EXPECT_NEAR(v.percentiles.max, 0, 1e-15);
  const DistanceStats d = surface_distance(mesh, make_tree(test::square(1, 0)), {.samples = 1000});
  EXPECT_NEAR(d.max, 0, 1e-15);
}

TEST(SurfaceDistance, SameBitsForAnyNumberOfThreads) {
  const SurfaceMesh a = test::random_soup(11, 500), b = test::random_soup(12, 40'000);
  const auto measured = [&](int threads) {
    tbb::task_arena arena(threads);
    return arena.execute([&] { return symmetric_distance(a, b, {.samples = 20'000, .seed = 3}); });
  };
  const SymmetricDistance one = measured(1), four = measured(4);
  EXPECT_EQ(one.mean, four.mean);
  EXPECT_EQ(one.rms, four.rms);
  EXPECT_EQ(one.max, four.max);
  EXPECT_EQ(one.forward.worst, four.forward.worst);
  const SymmetricDistance other_seed = symmetric_distance(a, b, {.samples = 20'000, .seed = 4});
  EXPECT_NE(one.mean, other_seed.mean);
  EXPECT_NEAR(one.mean, other_seed.mean, 0.02 * one.mean);
}

}  // namespace
}  // namespace cuesta::measure
