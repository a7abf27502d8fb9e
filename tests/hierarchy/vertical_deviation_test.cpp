/// Distances along a vertical: on a plane, on an ellipsoid, and where no triangle lies above or below.

#include "hierarchy/vertical_deviation.h"

#include <gtest/gtest.h>

#include <random>

#include "hierarchy/deviation.h"

namespace cuesta {
namespace {

using Corners = std::array<Vec3f, 3>;

const Vertical plane{};
const Vertical globe{{0, 0, 1}, false, {0, 0, -3'000'000}, 0.00674};

DeviationBatch batch_on(const Vertical& vertical) {
  return DeviationBatch(LocalVertical(vertical, {0, 0, 0}));
}

double distance_to(const Corners& triangle, Vec3f p, const Vertical& vertical = plane) {
  DeviationBatch batch = batch_on(vertical);
  batch.add(p);
  batch.measure({&triangle, 1});
  return std::sqrt(double(batch.squared_distance(0)));
}

TEST(VerticalDeviation, on_a_plane_is_the_difference_of_heights) {
  const Corners flat{Vec3f{0, 0, 0}, Vec3f{100, 0, 0}, Vec3f{0, 100, 0}};
  EXPECT_FLOAT_EQ(float(distance_to(flat, {20, 30, 7})), 7);
  EXPECT_FLOAT_EQ(float(distance_to(flat, {20, 30, -7})), 7);
  EXPECT_FLOAT_EQ(float(distance_to(flat, {0, 0, 3})), 3);
  // z = x: straight down it is 30, to the nearest point 21.2.
  const Corners slope{Vec3f{0, 0, 0}, Vec3f{100, 0, 100}, Vec3f{0, 100, 0}};
  EXPECT_NEAR(distance_to(slope, {20, 30, 50}), 30, 1e-4);
}

TEST(VerticalDeviation, through_no_triangle_is_the_distance_beside) {
  const Corners flat{Vec3f{0, 0, 0}, Vec3f{100, 0, 0}, Vec3f{0, 100, 0}};
  EXPECT_NEAR(distance_to(flat, {-3, 50, 4}), 5, 1e-5);
  // Steep to the rim x = 0: the triangle comes near the point, but beside it, it is 100 lower.
  const Corners steep{Vec3f{0, 0, 0}, Vec3f{10, 0, 100}, Vec3f{0, 100, 0}};
  EXPECT_NEAR(distance_to(steep, {-3, 50, 100}), std::hypot(3, 100), 1e-4);
  EXPECT_NEAR(distance_to(steep, {-0.125f, 50, 100}), 100, 1e-3);
  // A wall, and a triangle that faces down, have no above and no below.
  const Corners wall{Vec3f{0, 0, 0}, Vec3f{100, 0, 0}, Vec3f{0, 0, 100}};
  EXPECT_NEAR(distance_to(wall, {20, 8, 30}), 8, 1e-5);
  const Corners down{flat[0], flat[2], flat[1]};
  EXPECT_NEAR(distance_to(down, {20, 30, 6}), 6, 1e-5);
  EXPECT_NEAR(distance_to({Vec3f{0, 0, 0}, Vec3f{50, 0, 0}, Vec3f{100, 0, 0}}, {20, 0, 6}), 6, 1e-5);
}

TEST(VerticalDeviation, the_triangle_that_is_above_counts_not_the_nearest) {
  const std::array<Corners, 2> triangles{Corners{Vec3f{0, 0, 0}, Vec3f{100, 0, 0}, Vec3f{0, 100, 0}},
                                         Corners{Vec3f{-100, 0, 12}, Vec3f{0, 0, 12}, Vec3f{0, 100, 12}}};
  DeviationBatch batch = batch_on(plane);
  batch.add({-1, 50, 1});  // 1.4 from the first one
  batch.add({5, 50, 1});
  batch.measure(triangles, 7);
  EXPECT_FLOAT_EQ(batch.squared_distance(0), 121);
  EXPECT_EQ(batch.nearest(0), 8);
  EXPECT_FLOAT_EQ(batch.squared_distance(1), 1);
  EXPECT_EQ(batch.nearest(1), 7);
  EXPECT_GE(batch.worst_bound(), 11.0f);
  EXPECT_LT(batch.worst_bound(), 11.01f);
}

/// A point is lifted off a triangle along its own vertical.
TEST(VerticalDeviation, on_an_ellipsoid_is_along_its_normal) {
  std::mt19937 random(1);
  const auto between = [&](float least, float most) {
    return std::uniform_real_distribution<float>(least, most)(random);
  };
  for (int i = 0; i < 500; ++i) {
    const Corners t{Vec3f{between(-9000, -4000), between(-9000, -4000), between(-500, 500)},
                    Vec3f{between(4000, 9000), between(-9000, -4000), between(-500, 500)},
                    Vec3f{between(-4000, 4000), between(4000, 9000), between(-500, 500)}};
    const Vec3f on = t[0] * 0.3f + t[1] * 0.3f + t[2] * 0.4f;
    const float lift = between(1, 400);
    const Vec3d up = normalized(globe.direction(vec_cast<double>(on)));
    const double found = distance_to(t, on + vec_cast<float>(up) * lift, globe);
    EXPECT_NEAR(found, double(lift), 0.02) << i;
  }
}

TEST(VerticalDeviation, inside_is_in_grid_units) {
  const std::array<Corners, 2> triangles{Corners{Vec3f{0, 0, 0}, Vec3f{4000, 0, 0}, Vec3f{0, 300, 90}},
                                         Corners{Vec3f{4000, 0, 0}, Vec3f{4000, 300, 0}, Vec3f{0, 300, 90}}};
  for (const Vertical& vertical : {plane, globe}) {
    DeviationBatch batch = batch_on(vertical);
    batch.add({1, 100, 0});
    batch.add({300, 2, 0});
    batch.add({300, -7, 0});
    batch.add({3997, 200, 0});
    batch.measure(triangles);
    for (const auto& [i, inside] : {std::pair{0u, 1.0}, {1u, 2.0}, {2u, -7.0}, {3u, 3.0}})
      EXPECT_NEAR(double(batch.inside(i)), inside, 0.02) << i;
  }
}

/// In f64, by Cramer's rule; -1 where the vertical misses the triangle.
double brute_force(const Corners& corners, Vec3f point, const Vertical& vertical) {
  const Vec3d a = vec_cast<double>(corners[0]), ab = vec_cast<double>(corners[1]) - a,
              ac = vec_cast<double>(corners[2]) - a, q = vec_cast<double>(point) - a;
  const Vec3d up = normalized(vertical.direction(vec_cast<double>(point)));
  const double det = dot(up, cross(ab, ac));
  if (!(det > 0)) return -1;
  const double b = dot(up, cross(q, ac)) / det, c = dot(up, cross(ab, q)) / det;
  if (b < 0 || c < 0 || b + c > 1) return -1;
  return std::abs(dot(q, cross(ab, ac))) / det;
}

/// A grid of triangles without gaps below random points: every one lies above or below some triangle.
TEST(VerticalDeviation, bounds_the_distance_of_every_point_that_lies_over_a_triangle) {
  std::mt19937 random(2);
  const auto whole = [&](int size) { return float(int(random() % (2 * unsigned(size) + 1)) - size); };
  for (const Vertical& vertical : {plane, globe})
    for (const int size : {40, 900, 30'000})
      for (int i = 0; i < 100; ++i) {
        const float s = float(size);
        const Vec3f rim[4] = {{-s, -s, whole(size / 4)},
                              {s, -s, whole(size / 4)},
                              {s, s, whole(size / 4)},
                              {-s, s, whole(size / 4)}};
        const Vec3f middle{whole(size / 3), whole(size / 3), whole(size / 4)};
        std::array<Corners, 4> fan;
        for (std::size_t k = 0; k < 4; ++k) fan[k] = {middle, rim[k], rim[(k + 1) % 4]};
        DeviationBatch batch = batch_on(vertical);
        double worst = 0;
        for (int k = 0; k < 61; ++k) {
          const Vec3f p{whole(size * 9 / 10), whole(size * 9 / 10), whole(size / 3)};
          batch.add(p);
          double distance = -1;
          for (const Corners& t : fan) distance = std::max(distance, brute_force(t, p, vertical));
          ASSERT_GE(distance, 0);
          worst = std::max(worst, distance);
        }
        batch.measure(fan);
        EXPECT_GE(double(batch.worst_bound() + DeviationBatch::negligible), worst) << size << ", case " << i;
        EXPECT_LE(double(batch.worst_bound()), worst * 1.001 + size * 1e-4) << size << ", case " << i;
      }
}

TEST(VerticalDeviation, same_point_gives_the_same_bits_in_any_batch) {
  std::mt19937 random(3);
  for (const Vertical& vertical : {plane, globe}) {
    const Corners t{Vec3f{-900, -800, 3}, Vec3f{700, -650, 40}, Vec3f{100, 900, -20}};
    DeviationBatch all = batch_on(vertical);
    for (int i = 0; i < 67; ++i)
      all.add({float(random() % 2000) - 1000, float(random() % 2000) - 1000, float(random() % 100)});
    all.measure({&t, 1});
    for (std::size_t i = 0; i < all.size(); ++i)
      EXPECT_EQ(std::sqrt(double(all.squared_distance(i))), distance_to(t, all.point(i), vertical)) << i;
  }
}

}  // namespace
}  // namespace cuesta
