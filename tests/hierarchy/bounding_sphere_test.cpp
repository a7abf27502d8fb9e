#include "hierarchy/bounding_sphere.h"

#include <gtest/gtest.h>

#include <random>

namespace cuesta {
namespace {

/// Of the radius of the smallest ball, and two grid units: the stored radius and offset alone cost up to 4 %.
constexpr double slackest = 1.10;

std::vector<Sphere> random_balls(std::mt19937& random, Vec3f at, float size) {
  std::uniform_real_distribution<float> unit(-1, 1);
  std::vector<Sphere> balls(1 + random() % 20);
  for (Sphere& b : balls)
    b = {at + Vec3f{unit(random), unit(random), unit(random)} * size,
         random() % 2 ? 0 : std::abs(unit(random)) * size};
  return balls;
}

/// Radius of a ball around all, its centre found by many small steps.
double nearly_smallest(std::span<const Sphere> balls) {
  Vec3d c = vec_cast<double>(balls[0].centre);
  double best = 1e30;
  for (int step = 1; step <= 4000; ++step) {
    double far = -1;
    const Sphere* farthest = nullptr;
    for (const Sphere& b : balls) {
      const double d = length(vec_cast<double>(b.centre) - c) + static_cast<double>(b.radius);
      if (d > far) far = d, farthest = &b;
    }
    best = std::min(best, far);
    const Vec3d to = vec_cast<double>(farthest->centre) - c;
    if (length(to) > 0) c = c + normalized(to) * (far / (step + 1));
  }
  return best;
}

TEST(Enclose, contains_all) {
  std::mt19937 random(1);
  for (int i = 0; i < 3000; ++i) {
    const float size = std::exp2(static_cast<float>(random() % 20));
    const Vec3i centre{static_cast<int>(random() % 1000000), static_cast<int>(random() % 1000), 5};
    const auto balls = random_balls(random, vec_cast<float>(centre), size);
    const Sphere outer = decode_sphere(enclose(balls, centre), centre);
    for (const Sphere& b : balls) EXPECT_TRUE(contains(outer, b)) << "seed 1, case " << i;
  }
}

TEST(Enclose, near_minimal) {
  std::mt19937 random(2);
  for (int i = 0; i < 300; ++i) {
    const auto balls = random_balls(random, {1000, 2000, 3000}, 100);
    const Vec3i centre = vec_cast<std::int32_t>(balls[0].centre);
    const Sphere outer = decode_sphere(enclose(balls, centre), centre);
    EXPECT_LE(static_cast<double>(outer.radius), nearly_smallest(balls) * slackest + 2)
        << "seed 2, case " << i;
  }
}

TEST(Enclose, one_point_and_one_ball) {
  const Vec3i at{10, 20, 30};
  const Sphere point{vec_cast<float>(at), 0}, ball{vec_cast<float>(at), 7};
  EXPECT_EQ(decode_sphere(enclose(std::span(&point, 1), at), at).radius, 0.0f);
  EXPECT_LE(decode_sphere(enclose(std::span(&ball, 1), at), at).radius, 7.1f);
}

/// As when fan after fan contains the one before: the radius must not creep.
TEST(Enclose, nested_a_hundred_times_grows_little) {
  const Vec3i at{500, 500, 500};
  Sphere s{vec_cast<float>(at), 100};
  for (int i = 0; i < 100; ++i) s = decode_sphere(enclose(std::span(&s, 1), at), at);
  EXPECT_LE(s.radius, 101.0f);
}

}  // namespace
}  // namespace cuesta
