#include "hierarchy/deviation.h"

#include <gtest/gtest.h>

#include <random>

#include "hierarchy/quadric.h"

namespace cuesta {
namespace {

double to_segment(Vec3d p, Vec3d a, Vec3d b) {
  const Vec3d e = b - a;
  const double t = dot(e, e) > 0 ? std::clamp(dot(p - a, e) / dot(e, e), 0.0, 1.0) : 0.0;
  return length(p - (a + e * t));
}

/// The nearest point is on the plane inside the triangle, or on an edge.
double to_triangle(Vec3d p, Vec3d a, Vec3d b, Vec3d c) {
  double d = std::min({to_segment(p, a, b), to_segment(p, b, c), to_segment(p, c, a)});
  const Vec3d n = cross(b - a, c - a);
  if (dot(n, n) > 0 && dot(cross(b - a, n), p - a) <= 0 && dot(cross(c - b, n), p - b) <= 0 &&
      dot(cross(a - c, n), p - c) <= 0)
    d = std::min(d, std::abs(dot(p - a, n)) / length(n));
  return d;
}

Vec3f random_point(std::mt19937& random, int size) {
  const auto coordinate = [&] {
    return static_cast<float>(static_cast<int>(random() % (2 * static_cast<unsigned>(size))) - size);
  };
  return {coordinate(), coordinate(), coordinate()};
}

/// Float against f64, on grid points. Relative to the triangle's size, for sizes that cells have.
void compare(std::uint32_t seed, int points, int size, double tolerance) {
  std::mt19937 random(seed);
  for (int i = 0; i < 300; ++i) {
    DeviationBatch batch;
    for (int k = 0; k < points; ++k) batch.add(random_point(random, size));
    std::vector<double> expected(batch.size(), 1e30);
    for (std::int32_t t = 0; t < 3; ++t) {
      const Vec3f a = random_point(random, size), b = random_point(random, size),
                  c = random_point(random, size);
      batch.measure(a, b, c, t);
      for (std::size_t k = 0; k < batch.size(); ++k)
        expected[k] = std::min(expected[k], to_triangle(vec_cast<double>(batch.point(k)), vec_cast<double>(a),
                                                        vec_cast<double>(b), vec_cast<double>(c)));
    }
    double worst = 0;
    for (std::size_t k = 0; k < batch.size(); ++k) {
      EXPECT_NEAR(std::sqrt(batch.squared_distance(k)), expected[k], tolerance * size)
          << "seed " << seed << ", case " << i;
      EXPECT_GE(batch.nearest(k), 0);
      worst = std::max(worst, expected[k]);
    }
    EXPECT_GE(static_cast<double>(batch.worst_bound() + DeviationBatch::negligible), worst)
        << "seed " << seed << ", case " << i;
    EXPECT_NEAR(batch.worst_bound(), worst, tolerance * size);
  }
}

// A loop's vectors and its rest take different instructions: both numbers of points.
TEST(Deviation, few_points) {
  compare(1, 3, 1000, 1e-4);
}
TEST(Deviation, many_points) {
  compare(2, 67, 1000, 1e-4);
}
TEST(Deviation, tiny_triangles) {
  compare(3, 20, 3, 1e-4);
}
TEST(Deviation, large_coordinates) {
  compare(4, 20, 1 << 20, 1e-4);
}

// Long triangles of a width of a few grid units: a float normal would point anywhere.
TEST(Deviation, bounds_needles) {
  std::mt19937 random(5);
  for (const int size : {1000, 30000, 1 << 20})
    for (int i = 0; i < 20000; ++i) {
      const Vec3f a = random_point(random, size), b = random_point(random, size);
      const auto along = [&](int off) {
        const Vec3f m = a + (b - a) * (static_cast<float>(random() % 1000) / 1000);
        return Vec3f{std::round(m.x), std::round(m.y), std::round(m.z)} + random_point(random, off);
      };
      const Vec3f c = along(3), p = along(1 << (1 + random() % 7));
      DeviationBatch batch;
      batch.add(p);
      batch.measure(a, b, c, 0);
      const double distance =
          to_triangle(vec_cast<double>(p), vec_cast<double>(a), vec_cast<double>(b), vec_cast<double>(c));
      ASSERT_GE(static_cast<double>(batch.worst_bound() + DeviationBatch::negligible), distance)
          << "size " << size << ", case " << i;
      ASSERT_LE(static_cast<double>(batch.worst_bound()), distance * 1.0001 + size * 2e-5) << "case " << i;
    }
}

TEST(Deviation, degenerate_triangles_are_edges_and_points) {
  DeviationBatch batch;
  batch.add({0, 3, 0});
  batch.measure({-5, 0, 0}, {0, 0, 0}, {5, 0, 0}, 0);
  EXPECT_FLOAT_EQ(batch.squared_distance(0), 9);
  batch.measure({0, 1, 0}, {0, 1, 0}, {0, 1, 0}, 1);
  EXPECT_FLOAT_EQ(batch.squared_distance(0), 4);
  EXPECT_EQ(batch.nearest(0), 1);
}

TEST(Deviation, same_point_gives_the_same_bits_in_any_batch) {
  std::mt19937 random(5);
  std::vector<Vec3f> points;
  for (int i = 0; i < 67; ++i) points.push_back(random_point(random, 1000));
  const Vec3f a = random_point(random, 1000), b = random_point(random, 1000), c = random_point(random, 1000);
  DeviationBatch all;
  for (const Vec3f& p : points) all.add(p);
  all.measure(a, b, c, 0);
  for (std::size_t i = 0; i < points.size(); ++i) {
    DeviationBatch one;
    one.add(points[i]);
    one.measure(a, b, c, 0);
    EXPECT_EQ(one.squared_distance(0), all.squared_distance(i));
  }
}

TEST(Quadric, shifted_sum_is_the_sum_of_planes) {
  std::mt19937 random(6);
  for (int i = 0; i < 200; ++i) {
    const Vec3f here = random_point(random, 50), there = random_point(random, 50),
                at = random_point(random, 50);
    Quadric sum, other;
    double expected = 0, weights = 0;
    for (int k = 0; k < 6; ++k) {
      const Vec3f n = normalized(random_point(random, 10) + Vec3f{0.5f, 0, 0});
      const float w = static_cast<float>(1 + random() % 9);
      (k % 2 ? sum : other).add_plane(n, w);
      const double d = dot(vec_cast<double>(n), vec_cast<double>(at - (k % 2 ? here : there)));
      expected += static_cast<double>(w) * d * d;
      weights += static_cast<double>(w);
    }
    sum.add(other, there - here);
    EXPECT_NEAR(sum.at(at - here), expected, 1e-5 * weights * 30000) << "seed 6, case " << i;
    EXPECT_FLOAT_EQ(sum.weight, static_cast<float>(weights));
  }
}

TEST(Quadric, zero_on_its_planes) {
  Quadric q;
  q.add_plane({0, 0, 1}, 3);
  EXPECT_EQ(q.at({4, 5, 0}), 0.0f);
  EXPECT_FLOAT_EQ(q.at({4, 5, 2}), 12);
}

}  // namespace
}  // namespace cuesta
