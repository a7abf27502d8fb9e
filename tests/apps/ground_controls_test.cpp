/// Cameras over terrain: up, speed, and never below the ground.

#include <gtest/gtest.h>

#include <cmath>

#include "apps/view/camera_controls.h"

namespace cuesta::test {
namespace {

using namespace cuesta::view;

constexpr double radius = 6.4e6;

/// A ball of that radius around the origin.
std::optional<Vec3d> ball(Vec3d origin, Vec3d direction) {
  const double ahead = dot(origin, direction);
  const double inside = ahead * ahead - dot(origin, origin) + radius * radius;
  if (inside < 0) return {};
  double t = -ahead - std::sqrt(inside);
  if (t <= 0) t = -ahead + std::sqrt(inside);
  if (t <= 0) return {};
  return origin + direction * t;
}
Vec3d up_of_ball(Vec3d p) {
  return normalized(p);
}

CameraControls over_ball(double height, Vec3d place = {0, 0, 1}) {
  CameraControls controls(ball);
  controls.set_model_size(2 * radius);
  controls.set_ground({.up = up_of_ball});
  View view;
  const Vec3d up = normalized(place), ahead = normalized(cross(up, Vec3d{0.3, 0.9, 0.1}));
  view.eye = up * (radius + height);
  view.target = view.eye + ahead * 1000.0 - up * 200.0;
  view.up = up;
  controls.set_view(view);
  return controls;
}

WindowEvent key(char c, WindowEvent::Kind kind = WindowEvent::Kind::key_down) {
  WindowEvent e;
  e.kind = kind;
  e.key = key_of(c);
  return e;
}

double height(const CameraControls& controls) {
  return length(controls.view().eye) - radius;
}
/// Sine of the angle between the line of sight and the horizon.
double pitch(const View& view) {
  return dot(normalized(view.target - view.eye), view.up);
}

TEST(GroundControls, FlyingIsAsFastAsItIsHigh) {
  for (const double h : {10.0, 1000.0, 100000.0}) {
    CameraControls controls = over_ball(h);
    controls.set_mode(ControlMode::fly);
    EXPECT_NEAR(controls.height_above_ground().value(), h, 1e-6);
    const double speed = controls.speed();
    EXPECT_NEAR(speed / h, 0.75, 1e-6);
    controls.handle(key('W'));
    const Vec3d before = controls.view().eye;
    controls.advance(0.1);
    EXPECT_NEAR(length(controls.view().eye - before), 0.1 * speed, 1e-3 * speed);
  }
}

TEST(GroundControls, UpIsThatOfThePlaceAndTheHorizonStays) {
  CameraControls controls = over_ball(50000);
  controls.set_mode(ControlMode::fly);
  const double first = pitch(controls.view());
  View level = controls.view();
  level.target = level.target + level.up * dot(level.eye - level.target, level.up);
  controls.set_view(level);
  controls.handle(key('W'));
  for (int i = 0; i < 300; ++i) controls.advance(0.1);
  EXPECT_GT(std::acos(dot(controls.view().up, Vec3d{0, 0, 1})), 0.1) << "it went far around";
  EXPECT_LT(length(controls.view().up - up_of_ball(controls.view().eye)), 1e-12);
  EXPECT_NEAR(pitch(controls.view()), 0, 1e-6);
  EXPECT_NEAR(height(controls) / 50000, 1, 0.2) << "level flight follows the curve";
  EXPECT_LT(first, -0.1);
}

TEST(GroundControls, FlyingStaysAboveTheGround) {
  CameraControls controls = over_ball(500);
  controls.set_mode(ControlMode::fly);
  View down = controls.view();
  down.target = down.eye - down.up * 1000.0 + Vec3d{0, 300, 0};
  controls.set_view(down);
  controls.handle(key('W'));
  for (int i = 0; i < 500; ++i) {
    controls.advance(0.1);
    ASSERT_GE(height(controls), 2 - 1e-6) << i;
  }
  EXPECT_LT(height(controls), 10);
  View below = controls.view();
  below.eye = below.eye * (1 - 1e-4);
  below.target = below.eye + Vec3d{0, 100, 0};
  controls.set_view(below);
  controls.advance(0.01);
  EXPECT_NEAR(height(controls), 2, 1e-3) << "from under the ground it is lifted";
}

TEST(GroundControls, WalkingKeepsEyeHeightAroundTheBall) {
  CameraControls controls = over_ball(300, {1, 1, 1});
  controls.set_mode(ControlMode::walk);
  for (int i = 0; i < 200; ++i) controls.advance(0.05);
  EXPECT_NEAR(height(controls), 2, 0.01);
  controls.handle(key('W'));
  for (int i = 0; i < 400; ++i) controls.advance(0.05);
  EXPECT_NEAR(height(controls), 2, 0.01);
  EXPECT_LT(length(controls.view().up - up_of_ball(controls.view().eye)), 1e-12);
}

TEST(GroundControls, WhenTheGroundIsDrawnFinerTheEyeComesToIt) {
  double rise = 0;
  CameraControls controls([&](Vec3d origin, Vec3d direction) {
    auto hit = ball(origin - Vec3d{0, 0, rise}, direction);
    if (hit) hit->z += rise;
    return hit;
  });
  controls.set_model_size(2 * radius);
  controls.set_ground({.up = up_of_ball});
  controls.set_view(over_ball(50).view());
  controls.set_mode(ControlMode::walk);
  for (int i = 0; i < 200; ++i) controls.advance(0.05);
  EXPECT_FALSE(controls.moving());
  rise = 30;
  controls.surface_changed();
  EXPECT_TRUE(controls.moving());
  for (int i = 0; i < 200; ++i) controls.advance(0.05);
  EXPECT_NEAR(height(controls), 32, 0.01);
  controls.set_mode(ControlMode::fly);
  rise = 100;
  controls.surface_changed();
  EXPECT_NEAR(height(controls), 102, 0.01) << "flying: at once";
}

/// Ground at z = 0 within a square only.
std::optional<Vec3d> square(Vec3d origin, Vec3d direction) {
  if (direction.z == 0) return {};
  const double t = -origin.z / direction.z;
  const Vec3d p = origin + direction * t;
  if (t <= 0 || std::abs(p.x) > 1000 || std::abs(p.y) > 1000) return {};
  return p;
}

TEST(GroundControls, FromBesideTerrainOneWalksOnWhatIsInTheMiddle) {
  CameraControls controls(square);
  controls.set_model_size(2800);
  controls.set_ground({.up = [](Vec3d) { return Vec3d{0, 0, 1}; }});
  View view;
  view.eye = {0, -3000, 1500};
  view.target = {0, 0, 0};
  view.up = {0, 0, 1};
  controls.set_view(view);
  EXPECT_FALSE(controls.height_above_ground());
  controls.set_mode(ControlMode::fly);
  EXPECT_NEAR(controls.speed(), 0.75 * length(view.eye), 1) << "as if the ground were as far below";
  controls.set_view(view);
  controls.set_mode(ControlMode::walk);
  EXPECT_LT(length(controls.view().eye - Vec3d{0, 0, 2}), 1e-6);
}

TEST(GroundControls, LevelledKeepsPitchAndHeading) {
  View view;
  view.eye = {0, 0, 10};
  view.target = {3, 4, 8};
  view.up = {0, 0, 1};
  const Vec3d up = normalized(Vec3d{0.01, 0.02, 1});
  const View v = levelled(view, up);
  EXPECT_EQ(v.up, up);
  EXPECT_EQ(v.eye, view.eye);
  EXPECT_NEAR(pitch(v), pitch(view), 1e-9);
  EXPECT_LT(length(normalized(v.target - v.eye) - normalized(view.target - view.eye)), 0.03);
}

}  // namespace
}  // namespace cuesta::test
