/// Scenes as structs: transforms, clips, and what makes one faulty.

#include "ooc/scene.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>

namespace cuesta {
namespace {

const double half = std::sqrt(0.5);

TEST(Scene, WorldTransformsFollowParents) {
  Scene scene;
  Trs turned;  // a quarter turn about z: x becomes y
  turned.rotation = {0, 0, half, half};
  turned.translation = {10, 0, 0};
  scene.nodes = {{"root", no_index, no_index, no_index, turned},
                 {"child", 0, no_index, no_index, Affine{{Vec3d{2, 0, 0}, {0, 2, 0}, {0, 0, 2}}, {1, 0, 0}}}};
  const auto world = world_transforms(scene);
  const Vec3d p = world[1].point({1, 0, 0});
  EXPECT_NEAR(p.x, 10, 1e-12);
  EXPECT_NEAR(p.y, 3, 1e-12);
  EXPECT_NEAR(p.z, 0, 1e-12);
  EXPECT_NEAR(determinant(world[1]), 8, 1e-12);
}

TEST(Scene, NormalsOfMirroredAndStretchedMapsStayOutside) {
  const Affine mirrored{{Vec3d{-1, 0, 0}, {0, 1, 0}, {0, 0, 1}}, {}};
  EXPECT_EQ(normalized(map_normal(mirrored, {1, 0, 0})), (Vec3d{-1, 0, 0}));
  EXPECT_EQ(normalized(map_normal(mirrored, {0, 1, 0})), (Vec3d{0, 1, 0}));
  const Affine stretched{{Vec3d{4, 0, 0}, {0, 1, 0}, {0, 0, 1}}, {}};  // x + y = 1 becomes x / 4 + y = 1
  const Vec3d n = normalized(map_normal(stretched, normalized(Vec3d{1, 1, 0})));
  EXPECT_NEAR(n.y / n.x, 4, 1e-12);
}

TEST(Scene, BoxesOfMapsHoldTheirCorners) {
  const Affine turned = affine_of(Trs{{5, 0, 0}, {0, 0, half, half}, {1, 1, 1}});
  const Box3d box = map_box(turned, {{0, 0, 0}, {2, 1, 1}});
  EXPECT_NEAR(box.lo.x, 4, 1e-12);
  EXPECT_NEAR(box.hi.y, 2, 1e-12);
  EXPECT_TRUE(map_box(turned, Box3d{}).empty());
}

SceneChannel channel(AnimatedProperty property, Interpolation way, std::vector<float> times,
                     std::vector<float> values) {
  return {0, property, way, std::move(times), std::move(values)};
}

TEST(Clip, StepAndLinearHoldTheirEnds) {
  const auto linear =
      channel(AnimatedProperty::translation, Interpolation::linear, {1, 3}, {0, 0, 0, 4, 8, -2});
  EXPECT_EQ(value_at(linear, 0)[0], 0);
  EXPECT_EQ(value_at(linear, 2)[0], 2);
  EXPECT_EQ(value_at(linear, 2)[1], 4);
  EXPECT_EQ(value_at(linear, 9)[2], -2);
  const auto step = channel(AnimatedProperty::scale, Interpolation::step, {1, 3}, {1, 1, 1, 2, 2, 2});
  EXPECT_EQ(value_at(step, 2.999)[0], 1);
  EXPECT_EQ(value_at(step, 3)[0], 2);
}

TEST(Clip, RotationsGoTheShortWayAndStayUnit) {
  const auto h = static_cast<float>(half);
  // 0° to 90° about z, the second key with the other sign: the same rotation.
  const auto turn =
      channel(AnimatedProperty::rotation, Interpolation::linear, {0, 1}, {0, 0, 0, 1, 0, 0, -h, -h});
  for (const double t : {0.25, 0.5, 0.75}) {
    const auto q = value_at(turn, t);
    EXPECT_NEAR(2 * std::atan2(std::abs(q[2]), std::abs(q[3])), t * std::numbers::pi / 2, 1e-6);
    EXPECT_NEAR(q[2] * q[2] + q[3] * q[3], 1, 1e-12);
  }
}

TEST(Clip, SplinesPassTheirKeysWithTheirTangents) {
  // From 0 with slope 2 to 1 with slope 0, over two seconds.
  const auto spline = channel(AnimatedProperty::translation, Interpolation::cubic, {0, 2},
                              {9, 9, 9, 0, 0, 0, 2, 0, 0, 0, 0, 0, 1, 0, 0, 9, 9, 9});
  EXPECT_EQ(value_at(spline, 0)[0], 0);
  EXPECT_EQ(value_at(spline, 2)[0], 1);
  EXPECT_NEAR((value_at(spline, 1e-6)[0] - value_at(spline, 0)[0]) / 1e-6, 2, 1e-5);
  EXPECT_NEAR((value_at(spline, 2)[0] - value_at(spline, 2 - 1e-6)[0]) / 1e-6, 0, 1e-5);
  EXPECT_NEAR(value_at(spline, 1)[0], 0.5 * 0 + 2 * 2 * 0.125 + 0.5 * 1, 1e-12);  // Hermite's at one half
}

TEST(Clip, ChangesWhatItMovesAndNothingElse) {
  std::vector<LocalTransform> locals{Trs{{1, 2, 3}, {0, 0, 0, 1}, {5, 5, 5}}, Affine{}};
  SceneClip clip;
  clip.channels = {channel(AnimatedProperty::translation, Interpolation::step, {0}, {7, 8, 9})};
  apply_clip(clip, 1, locals);
  EXPECT_EQ(std::get<Trs>(locals[0]), (Trs{{7, 8, 9}, {0, 0, 0, 1}, {5, 5, 5}}));
  EXPECT_EQ(std::get<Affine>(locals[1]), Affine{});
  EXPECT_EQ(clip.seconds(), 0);
}

Scene good_scene() {
  Scene scene;
  scene.materials.resize(1);
  scene.nodes = {{"a", no_index, no_index, no_index, Trs{}}, {"b", 0, 0, 0, Trs{}}};
  scene.clips = {
      {"clip", {channel(AnimatedProperty::scale, Interpolation::linear, {0, 1}, {1, 1, 1, 2, 2, 2})}}};
  return scene;
}

TEST(Scene, FaultsAreFound) {
  EXPECT_EQ(fault_of(good_scene(), 1), "");
  const auto faulty = [](auto&& change) {
    Scene scene = good_scene();
    change(scene);
    return !fault_of(scene, 1).empty();
  };
  constexpr double inf = std::numeric_limits<double>::infinity();
  EXPECT_TRUE(faulty([](Scene& s) { s.nodes[1].parent = 1; }));
  EXPECT_TRUE(faulty([](Scene& s) { s.nodes[0].parent = 1; }));
  EXPECT_TRUE(faulty([](Scene& s) { s.nodes[1].part = 1; }));
  EXPECT_TRUE(faulty([](Scene& s) { s.nodes[1].material = no_index; }));
  EXPECT_TRUE(faulty([](Scene& s) { s.nodes[1].material = 1; }));
  EXPECT_TRUE(faulty([](Scene& s) { s.nodes[0].material = 0; }));
  EXPECT_TRUE(faulty([=](Scene& s) { s.nodes[1].local = Trs{{inf, 0, 0}, {0, 0, 0, 1}, {1, 1, 1}}; }));
  EXPECT_TRUE(faulty([=](Scene& s) { s.nodes[1].local = Affine{{}, {0, inf, 0}}; }));
  EXPECT_TRUE(faulty([](Scene& s) { s.nodes[0].local = Affine{}; }));
  EXPECT_TRUE(faulty([](Scene& s) { s.materials[0].roughness = 2; }));
  EXPECT_TRUE(faulty([](Scene& s) { s.clips[0].channels[0].node = 2; }));
  EXPECT_TRUE(faulty([](Scene& s) { s.clips[0].channels[0].times_s = {1, 1}; }));
  EXPECT_TRUE(faulty([](Scene& s) { s.clips[0].channels[0].values.pop_back(); }));
  EXPECT_TRUE(faulty([](Scene& s) { s.clips[0].channels[0].times_s.clear(); }));
}

}  // namespace
}  // namespace cuesta
