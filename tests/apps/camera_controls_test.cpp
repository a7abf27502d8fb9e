/// What mouse and keys do to a camera, without a window.

#include "apps/view/camera_controls.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <random>

namespace cuesta::test {
namespace {

using namespace cuesta::view;
using Kind = WindowEvent::Kind;

View start_view() {
  View view;
  view.eye = {0, 0, 10};
  view.target = {0, 0, 0};
  view.width_px = 800;
  view.height_px = 600;
  return view;
}

/// The ground is y = 0, everywhere.
std::optional<Vec3d> plane(Vec3d origin, Vec3d direction) {
  if (direction.y == 0) return {};
  const double t = -origin.y / direction.y;
  if (t <= 0) return {};
  return origin + direction * t;
}
std::optional<Vec3d> nothing(Vec3d, Vec3d) {
  return {};
}

void expect_near(Vec3d a, Vec3d b, double tolerance) {
  for (int i = 0; i < 3; ++i) EXPECT_NEAR(a[i], b[i], tolerance) << "component " << i;
}

/// Pixel where a point is seen.
std::array<double, 2> pixel(const View& view, Vec3d p) {
  const auto [right, up, back] = view.frame();
  const Vec3d d = p - view.eye;
  const double k = view.pixels_per_unit() / -dot(d, back);
  return {view.width_px / 2.0 + k * dot(d, right), view.height_px / 2.0 - k * dot(d, up)};
}

WindowEvent key(Kind kind, Key k) {
  WindowEvent e;
  e.kind = kind;
  e.key = k;
  return e;
}
WindowEvent mouse(Kind kind, double x, double y, MouseButton button = MouseButton::left) {
  WindowEvent e;
  e.kind = kind;
  e.x = x;
  e.y = y;
  e.button = button;
  return e;
}
WindowEvent drag(double dx, double dy) {
  WindowEvent e = mouse(Kind::move, 0, 0);
  e.dx = dx;
  e.dy = dy;
  return e;
}
WindowEvent wheel(double notches, double x, double y) {
  WindowEvent e = mouse(Kind::scroll, x, y);
  e.notches = notches;
  return e;
}

TEST(CameraControls, OrbitKeepsTheDistanceAndTurnsWithThePointer) {
  const View view = start_view();
  const View right = orbited(view, 150, 0);
  expect_near(right.target, view.target, 0);
  EXPECT_NEAR(length(right.eye), 10, 1e-9);
  EXPECT_LT(right.eye.x, -6) << "the model turns to the right, so the eye goes left";
  EXPECT_NEAR(right.eye.y, 0, 1e-9);
  EXPECT_GT(orbited(view, 0, 100).eye.y, 4) << "downwards shows it from above";
  expect_near(orbited(orbited(view, 37, 0), -37, 0).eye, view.eye, 1e-9);
}

TEST(CameraControls, NoDragReachesThePolesOrAnInvalidCamera) {
  std::mt19937 random(7);
  std::uniform_real_distribution<double> step(-900, 900);
  View view = start_view();
  for (int i = 0; i < 2000; ++i) {
    view = i % 3 == 0 ? turned(view, step(random), step(random)) : orbited(view, step(random), step(random));
    const Vec3d line = normalized(view.target - view.eye);
    ASSERT_TRUE(std::isfinite(line.x + line.y + line.z));
    ASSERT_LT(std::abs(line.y), std::cos(std::numbers::pi / 180 * 0.99)) << i;
    ASSERT_NEAR(length(view.target - view.eye), 10, 1e-6);
  }
}

TEST(CameraControls, PanningTakesThePointUnderThePointerAlong) {
  const View view = start_view();
  const View v = panned(view, 40, -25);
  const auto before = pixel(view, {1, 2, 0}), after = pixel(v, {1, 2, 0});
  EXPECT_NEAR(after[0] - before[0], 40, 1e-6);
  EXPECT_NEAR(after[1] - before[1], -25, 1e-6);
}

TEST(CameraControls, ZoomingKeepsThePointUnderThePointerWhereItIs) {
  const View view = start_view();
  const Vec3d point{2, 1, 0};
  for (const double notches : {3.0, -2.0}) {
    const View v = zoomed(view, notches, point, 1e-6);
    const auto before = pixel(view, point), after = pixel(v, point);
    EXPECT_NEAR(after[0], before[0], 1e-6);
    EXPECT_NEAR(after[1], before[1], 1e-6);
    EXPECT_EQ(length(v.eye - point) < length(view.eye - point), notches > 0);
  }
  View v = view;
  for (int i = 0; i < 1000; ++i) v = zoomed(v, 1, {}, 0.5);
  EXPECT_NEAR(length(v.eye), 0.5, 1e-9);
}

TEST(CameraControls, RaysGoThroughTheirPixels) {
  View view = start_view();
  view.eye = {3, 4, 5};
  view.target = {-1, 0, 2};
  for (const auto& at : {std::array{400.0, 300.0}, std::array{10.0, 590.0}, std::array{777.5, 3.25}}) {
    const auto seen = pixel(view, view.eye + ray_direction(view, at[0], at[1]) * 7.0);
    EXPECT_NEAR(seen[0], at[0], 1e-6);
    EXPECT_NEAR(seen[1], at[1], 1e-6);
  }
}

TEST(CameraControls, LookingKeepsTheEye) {
  const View view = start_view();
  const View v = turned(view, 100, 0);
  expect_near(v.eye, view.eye, 0);
  EXPECT_GT(v.target.x, 0.5) << "to the right";
  EXPECT_LT(turned(view, 0, 100).target.y, -0.5) << "down";
}

TEST(CameraControls, OrbitByMouse) {
  CameraControls controls(nothing);
  controls.set_view(start_view());
  EXPECT_FALSE(controls.handle(drag(50, 0))) << "no button is down";
  controls.handle(mouse(Kind::button_down, 5, 5));
  EXPECT_TRUE(controls.dragging());
  controls.handle(drag(50, 0));
  controls.handle(mouse(Kind::button_up, 55, 5));
  EXPECT_FALSE(controls.dragging());
  expect_near(controls.view().eye, orbited(start_view(), 50, 0).eye, 1e-12);

  controls.set_view(start_view());
  controls.handle(mouse(Kind::button_down, 5, 5, MouseButton::right));
  controls.handle(drag(50, 0));
  controls.handle(mouse(Kind::button_up, 55, 5, MouseButton::right));
  expect_near(controls.view().eye, panned(start_view(), 50, 0).eye, 1e-12);
}

TEST(CameraControls, TheWheelGoesToWhatIsUnderThePointer) {
  CameraControls controls(plane);
  View view = start_view();
  view.eye = {0, 5, 10};
  view.target = {0, 5, 0};
  controls.set_view(view);
  const Vec3d under = *plane(view.eye, ray_direction(view, 300, 500));
  for (int i = 0; i < 60; ++i) controls.handle(wheel(1, 300, 500));
  EXPECT_LT(length(controls.view().eye - under), 1e-3);
  EXPECT_NEAR(pixel(controls.view(), under)[0], 300, 0.5);
}

TEST(CameraControls, ADoubleClickTurnsAboutWhatIsThere) {
  CameraControls controls(plane);
  View view = start_view();
  view.eye = {0, 5, 10};
  controls.set_view(view);
  const Vec3d there = *plane(view.eye, ray_direction(view, 500, 400));
  for (int i = 0; i < 2; ++i) {
    controls.handle(mouse(Kind::button_down, 500, 400));
    controls.handle(mouse(Kind::button_up, 500, 400));
  }
  expect_near(controls.view().target, there, 1e-9);
}

TEST(CameraControls, FlyMovesWhereItLooksWhileKeysAreHeld) {
  CameraControls controls(nothing);
  controls.set_view(start_view());
  controls.set_model_size(80);
  controls.set_mode(ControlMode::fly);
  EXPECT_FALSE(controls.advance(1)) << "nothing is held";
  controls.handle(key(Kind::key_down, key_of('W')));
  EXPECT_TRUE(controls.moving());
  EXPECT_TRUE(controls.advance(0.5));
  expect_near(controls.view().eye, {0, 0, 10 - 0.5 * controls.speed()}, 1e-9);
  controls.handle(key(Kind::key_down, Key::shift));
  controls.advance(0.1);
  expect_near(controls.view().eye, {0, 0, 10 - 0.9 * controls.speed()}, 1e-9);
  controls.handle(key(Kind::key_up, key_of('W')));
  EXPECT_FALSE(controls.moving());
  const double before = controls.speed();
  controls.handle(wheel(2, 0, 0));
  EXPECT_GT(controls.speed(), 1.5 * before);
  controls.handle(key(Kind::key_down, key_of('D')));
  WindowEvent leave;
  leave.kind = Kind::leave;
  controls.handle(leave);
  EXPECT_FALSE(controls.moving()) << "a window without the keyboard holds no keys";
}

TEST(CameraControls, WalkComesToItsHeightAndKeepsIt) {
  CameraControls controls(plane);
  View view = start_view();
  view.eye = {0, 7, 10};
  view.target = {0, 0, 0};
  controls.set_view(view);
  controls.set_model_size(100);
  controls.set_mode(ControlMode::walk);
  EXPECT_TRUE(controls.moving());
  for (int i = 0; i < 300 && controls.moving(); ++i) controls.advance(0.016);
  EXPECT_FALSE(controls.moving()) << "it comes to rest";
  const double height = controls.view().eye.y;
  EXPECT_NEAR(height, 0.5, 0.01);
  controls.handle(key(Kind::key_down, key_of('W')));
  for (int i = 0; i < 50; ++i) controls.advance(0.016);
  EXPECT_NEAR(controls.view().eye.y, height, 1e-9) << "looking down does not walk into the ground";
  EXPECT_LT(controls.view().eye.z, 9.9);
  controls.handle(key(Kind::key_up, key_of('W')));
  controls.handle(key(Kind::key_down, key_of('E')));
  for (int i = 0; i < 50; ++i) controls.advance(0.016);
  EXPECT_GT(controls.view().eye.y, 1.5 * height);
}

TEST(CameraControls, WalkStaysWhereNothingIsBelow) {
  CameraControls controls(nothing);
  controls.set_view(start_view());
  controls.set_mode(ControlMode::walk);
  controls.advance(0.1);
  EXPECT_FALSE(controls.moving());
  expect_near(controls.view().eye, start_view().eye, 0);
}

TEST(CameraControls, BackInOrbitTheMiddleIsTurnedAbout) {
  CameraControls controls(plane);
  View view = start_view();
  view.eye = {0, 5, 10};
  view.target = {0, 4.5, 9};
  controls.set_view(view);
  controls.set_mode(ControlMode::fly);
  controls.set_mode(ControlMode::orbit);
  EXPECT_NEAR(controls.view().target.y, 0, 1e-9);
  const auto at = pixel(view, controls.view().target);
  EXPECT_NEAR(at[0], 400, 1e-6);
  EXPECT_NEAR(at[1], 300, 1e-6);
}

}  // namespace
}  // namespace cuesta::test
