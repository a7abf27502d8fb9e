#include "runtime/relief.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "runtime/error_scale.h"

namespace cuesta {
namespace {

constexpr double equator = 6378137, pole = 6356752.314245;

Relief globe(double exaggeration = 1) {
  return {.equatorial_radius = equator, .polar_radius = pole, .exaggeration = exaggeration};
}

Relief tilted_plane(double exaggeration) {
  const Vec3d up = normalized(Vec3d{0.3, -0.5, 0.8}), east = normalized(cross(Vec3d{0, 1, 0}, up));
  return {.origin = {10, 20, 30}, .axes = {east, cross(up, east), up}, .exaggeration = exaggeration};
}

/// ECEF by the closed formula.
Vec3d place(double lat, double lon, double h) {
  const double e2 = 1 - (pole * pole) / (equator * equator);
  const double n = equator / std::sqrt(1 - e2 * std::sin(lat) * std::sin(lat));
  return {(n + h) * std::cos(lat) * std::cos(lon), (n + h) * std::cos(lat) * std::sin(lon),
          (n * (1 - e2) + h) * std::sin(lat)};
}
Vec3d normal_at(double lat, double lon) {
  return {std::cos(lat) * std::cos(lon), std::cos(lat) * std::sin(lon), std::sin(lat)};
}

TEST(Relief, HeightsAndUpOfTheEarth) {
  double worst = 0, tilt = 0;
  for (const double h : {-10000.0, -100.0, 0.0, 100.0, 8848.0, 100000.0})
    for (double lat = -1.57; lat < 1.58; lat += 0.05) {
      const Vec3d p = place(lat, 2.1 * lat, h);
      worst = std::max(worst, std::abs(globe().height(p) - h) / std::max(std::abs(h), 1.0));
      tilt = std::max(tilt, length(globe().up(p) - normal_at(lat, 2.1 * lat)));
    }
  EXPECT_LT(worst, 1e-5);
  EXPECT_LT(tilt, 1e-4);
  std::printf("worst height %.1e of itself, up %.1e rad\n", worst, tilt);
}

TEST(Relief, NorthIsLevel) {
  const Vec3d p = place(0.8, 0.1, 500);
  EXPECT_NEAR(dot(globe().north(p), globe().up(p)), 0, 1e-12);
  EXPECT_GT(globe().north(p).z, 0);
  EXPECT_NEAR(length(globe().north({0, 0, pole})), 1, 1e-12);
  EXPECT_EQ(tilted_plane(1).north({}), tilted_plane(1).axes[1]);
}

TEST(Relief, LoweredIsTheInverseOfRaised) {
  std::mt19937_64 random(3);
  std::uniform_real_distribution<double> unit(-1, 1);
  for (const double factor : {0.2, 1.0, 3.0, 20.0})
    for (int i = 0; i < 300; ++i) {
      const double h = 4000 + 6000 * unit(random);
      const Vec3d p = place(1.5 * unit(random), 3 * unit(random), h);
      EXPECT_LT(length(globe(factor).lowered(globe(factor).raised(p)) - p), 1e-6 * std::abs(h) + 1e-3)
          << factor;
      const Relief plane = tilted_plane(factor);
      const Vec3d q{1000 * unit(random), 1000 * unit(random), 1000 * unit(random)};
      EXPECT_LT(length(plane.lowered(plane.raised(q)) - q), 1e-8);
      EXPECT_NEAR(plane.height(plane.raised(q)), factor * plane.height(q), 1e-8);
    }
}

TEST(Relief, InAGridItIsTheSame) {
  const Grid grid{{4000000, 100000, 4900000}, 0.7};
  const Vec3d p = place(0.9, 0.02, 1234);
  EXPECT_NEAR(globe(2).in(grid).height((p - grid.origin) / grid.step) * grid.step, globe(2).height(p), 1e-6);
}

View looking(Vec3d eye, Vec3d target, Vec3d up) {
  View view;
  view.eye = eye;
  view.target = target;
  view.up = up;
  return view;
}

/// What no exaggerated scale may say: an error smaller on the screen than it is drawn.
TEST(ErrorScale, ExaggeratedErrorsAreNoLargerThanTold) {
  std::mt19937_64 random(17);
  std::uniform_real_distribution<double> unit(-1, 1);
  for (const double factor : {0.25, 2.0, 5.0})
    for (const bool plane : {true, false}) {
      const Vec3d middle = place(0.8, 0.3, 0);
      Relief relief = globe(factor);
      if (plane) relief = tilted_plane(factor), relief.origin = middle;
      const Vec3d up = relief.up(middle);
      const Grid grid{middle, 0.5};
      const auto near_middle = [&](double reach_m, double h_m) {
        const Vec3d off = Vec3d{unit(random), unit(random), unit(random)} * reach_m;
        return middle + (off - up * dot(off, up)) + up * h_m;
      };
      for (int i = 0; i < 500; ++i) {
        const View view = looking(near_middle(20000, 3000 + 8000 * (1 + unit(random))), middle, up);
        const auto scale = ErrorScale::perspective(grid, view).exaggerated(grid, relief);
        const Vec3d p = near_middle(20000, 2500 + 2500 * unit(random)), q = p + up * 10.0;
        const Sphere s{vec_cast<float>((p - grid.origin) / grid.step), 200.0f};
        const double drawn_m = length(relief.raised(q) - relief.raised(p));
        const double drawn_px = drawn_m * view.pixels_per_unit() / length(relief.raised(p) - view.eye);
        EXPECT_GE(scale.sse(20.0f, s), drawn_px * 0.99) << factor << " " << plane;
      }
    }
}

TEST(ErrorScale, ExaggeratedSurfacesInThePictureAreVisible) {
  Relief relief;  // z is up
  relief.exaggeration = 4;
  const Grid grid{{0, 0, 0}, 1};
  const View view = looking({0, -1000, 4000}, {0, 0, 4000}, {0, 0, 1});
  const auto plain = ErrorScale::perspective(grid, view), scaled = plain.exaggerated(grid, relief);
  const Sphere top{{0, 0, 1000}, 20}, foot{{0, 0, 0}, 20};
  EXPECT_TRUE(plain.invisible(top)) << "3000 below the line of sight";
  EXPECT_FALSE(scaled.invisible(top)) << "drawn at 4000";
  EXPECT_TRUE(scaled.invisible(foot));
  EXPECT_EQ(plain.exaggerated(grid, Relief{}), plain);
}

}  // namespace
}  // namespace cuesta
