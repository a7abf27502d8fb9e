#include "apps/measure/screen_error.h"

#include <gtest/gtest.h>

#include "apps/measure/surface_distance.h"
#include "measure_shapes.h"

namespace cuesta::measure {
namespace {

View camera_above() {
  View view;
  view.eye = {0.5, 0.5, 3};
  view.target = {0.5, 0.5, 0};
  return view;
}

TEST(ScreenError, OneVertexByHand) {
  const View view = camera_above();
  const std::vector<Vec3d> original{{0.5, 0.5, 0.5}};
  const ScreenError e = screen_error(original, make_tree(test::square(2, 0)), view);
  const double k = 720 / (2 * std::tan(view.fov_y_rad / 2));
  EXPECT_NEAR(e.px.max, k * 0.5 / 2.5, 1e-9);
  EXPECT_EQ(e.px.max, e.px.p50);
  EXPECT_EQ(e.px.count, 1u);
}

TEST(ScreenError, OnlyVerticesInTheFrustumUnlessAsked) {
  const View view = camera_above();
  // In the picture, beside it, behind the eye.
  const std::vector<Vec3d> original{{0.5, 0.5, 0.1}, {9, 0.5, 0.1}, {0.5, 0.5, 4}};
  EXPECT_TRUE(in_frustum(view, original[0]));
  EXPECT_FALSE(in_frustum(view, original[1]));
  EXPECT_FALSE(in_frustum(view, original[2]));
  const TriangleTree tree = make_tree(test::square(2, 0));
  EXPECT_EQ(screen_error(original, tree, view).px.count, 1u);
  EXPECT_EQ(screen_error(original, tree, view).worst, 0u);
  const ScreenError all = screen_error(original, tree, view, Region::everywhere);
  EXPECT_EQ(all.px.count, 3u);
  EXPECT_EQ(all.worst, 2u);
}

TEST(ScreenError, FrustumEdgesFollowTheAspectRatio) {
  const View view = camera_above();
  const double y = 3 * std::tan(view.fov_y_rad / 2), x = y * 1280 / 720;
  EXPECT_TRUE(in_frustum(view, {0.5 + x * 0.999, 0.5, 0}));
  EXPECT_FALSE(in_frustum(view, {0.5 + x * 1.001, 0.5, 0}));
  EXPECT_TRUE(in_frustum(view, {0.5, 0.5 + y * 0.999, 0}));
  EXPECT_FALSE(in_frustum(view, {0.5, 0.5 + y * 1.001, 0}));
}

TEST(ScreenError, KnownDistancesGiveTheSame) {
  const SurfaceMesh original = test::sphere(40, 0.5), simplified = test::sphere(12, 0.5);
  const TriangleTree tree = make_tree(simplified);
  const View view = camera_above();
  const ScreenError a = screen_error(original.positions, tree, view);
  const ScreenError b = screen_error(original.positions, point_distances(original.positions, tree), view);
  EXPECT_EQ(a.px.max, b.px.max);
  EXPECT_EQ(a.px.p99, b.px.p99);
  EXPECT_EQ(a.px.count, b.px.count);
  EXPECT_EQ(a.worst, b.worst);
  EXPECT_GT(a.px.max, 1);
}

TEST(ScreenError, EmptyInputs) {
  const View view = camera_above();
  const TriangleTree none = make_tree({});
  EXPECT_EQ(screen_error({}, none, view).px.count, 0u);
  const std::vector<Vec3d> original{{0.5, 0.5, 0}};
  EXPECT_TRUE(std::isinf(screen_error(original, none, view).px.max));
}

TEST(Percentiles, NearestRank) {
  std::vector<double> values;
  for (int i = 1000; i >= 1; --i) values.push_back(i);
  const Percentiles p = percentiles(values);
  EXPECT_EQ(p.p50, 500);
  EXPECT_EQ(p.p90, 900);
  EXPECT_EQ(p.p99, 990);
  EXPECT_EQ(p.p999, 999);
  EXPECT_EQ(p.max, 1000);
  EXPECT_EQ(p.count, 1000u);
}

}  // namespace
}  // namespace cuesta::measure
