#include "runtime/instance_culling.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

namespace cuesta::test {
namespace {

View view_of(Vec3d eye, Vec3d target) {
  View view;
  view.eye = eye, view.target = target, view.width_px = 400, view.height_px = 300;
  return view;
}

/// Picture coordinates of a point, ±1 at its edges; depth.
std::array<double, 3> project(const View& view, Vec3d p) {
  const auto [right, up, back] = view.frame();
  const Vec3d d = p - view.eye;
  const double depth = -dot(d, back), k = view.pixels_per_unit() / depth;
  return {dot(d, right) * k / (view.width_px / 2.0), dot(d, up) * k / (view.height_px / 2.0), depth};
}

class Random {
 public:
  explicit Random(std::uint64_t seed) : random_(seed) {}
  double operator()(double lo, double hi) { return std::uniform_real_distribution<double>(lo, hi)(random_); }
  Vec3d in_ball() {
    for (;;)
      if (const Vec3d v{(*this)(-1, 1), (*this)(-1, 1), (*this)(-1, 1)}; length(v) <= 1) return v;
  }

 private:
  std::mt19937_64 random_;
};

TEST(ViewCone, NeverLosesWhatCanBeSeen) {
  Random random(1);
  int seen = 0, culled = 0;
  for (int i = 0; i < 3000; ++i) {
    const View view = view_of(random.in_ball() * 5, random.in_ball() * 5 + Vec3d{9, 0, 0});
    const Ball ball{random.in_ball() * 10, random(0.01, 3)};
    bool visible = false;
    for (int k = 0; k < 50 && !visible; ++k) {
      const auto [x, y, depth] = project(view, ball.centre + ball.radius * random.in_ball());
      visible = depth > 0 && std::abs(x) <= 1 && std::abs(y) <= 1;
    }
    const bool may = ViewCone(view).may_see(ball);
    ASSERT_TRUE(may || !visible) << i;
    seen += visible ? 1 : 0, culled += may ? 0 : 1;
  }
  EXPECT_GT(seen, 200);
  EXPECT_GT(culled, 1000);
}

TEST(ViewCone, FootprintsOfABallInTheMiddle) {
  const View view = view_of({0, 0, 0}, {0, 0, -1});
  const auto f = ViewCone(view).footprint({{0, 0, -100}, 1});
  const double r_px = view.pixels_per_unit() / 100;
  EXPECT_NEAR(f.diameter_px, 2 * r_px, 0.01);
  EXPECT_NEAR(f.coverage, 4 * r_px * r_px / (400 * 300), 1e-5);
  EXPECT_EQ(f.from_centre, 0);
}

TEST(ViewCone, AroundTheEyeAllIsCovered) {
  const auto f = ViewCone(view_of({0, 0, 0}, {0, 0, -1})).footprint({{0, 0, 0.5}, 1});
  EXPECT_EQ(f.coverage, 1);
  EXPECT_TRUE(std::isinf(f.diameter_px));
}

TEST(ViewCone, HalfOutsideCoversHalf) {
  const View view = view_of({0, 0, 0}, {0, 0, -1});
  const double edge = 100 * 200 / view.pixels_per_unit();
  const auto middle = ViewCone(view).footprint({{0, 0, -100}, 1}),
             half = ViewCone(view).footprint({{edge, 0, -100}, 1});
  EXPECT_NEAR(half.coverage / middle.coverage, 0.5, 0.01);
  EXPECT_GT(half.from_centre, 0.7);
}

TEST(BallOf, HoldsTheBoxHoweverItIsTurned) {
  Random random(2);
  for (int i = 0; i < 300; ++i) {
    Affine a;
    for (Vec3d& c : a.columns) c = random.in_ball() * 3;
    a.translation = random.in_ball() * 50;
    Box3d box;
    box.add(random.in_ball());
    box.add(random.in_ball() * 4);
    const Ball ball = ball_of(a, box);
    for (int k = 0; k < 8; ++k) {
      const Vec3d corner{k & 1 ? box.hi.x : box.lo.x, k & 2 ? box.hi.y : box.lo.y,
                         k & 4 ? box.hi.z : box.lo.z};
      ASSERT_LE(length(a.point(corner) - ball.centre), ball.radius * (1 + 1e-12)) << i;
    }
  }
  EXPECT_EQ(ball_of(Affine{}, Box3d{}).radius, 0);
}

}  // namespace
}  // namespace cuesta::test
