#include "runtime/scene_pose.h"

#include <gtest/gtest.h>

namespace cuesta::test {
namespace {

SceneNode node(std::uint32_t parent, Vec3d at) {
  SceneNode n;
  n.parent = parent, n.local = Trs{at, {0, 0, 0, 1}, {1, 1, 1}};
  return n;
}

/// 0 ── 1 ── 2, and 3 on its own.
Scene chain() {
  Scene scene;
  scene.nodes = {node(no_index, {1, 0, 0}), node(0, {0, 2, 0}), node(1, {0, 0, 3}),
                 node(no_index, {9, 9, 9})};
  return scene;
}

std::vector<std::uint32_t> updated(ScenePose& pose) {
  const auto changed = pose.update();
  return {changed.begin(), changed.end()};
}

TEST(ScenePose, StartsAtRest) {
  const Scene scene = chain();
  ScenePose pose(scene);
  EXPECT_EQ(pose.world(2).translation, (Vec3d{1, 2, 3}));
  EXPECT_TRUE(updated(pose).empty());
}

TEST(ScenePose, WhatHangsOnANodeMovesAlong) {
  const Scene scene = chain();
  ScenePose pose(scene);
  pose.set_local(1, Trs{{0, 5, 0}, {0, 0, 0, 1}, {2, 2, 2}});
  EXPECT_EQ(pose.world(2).translation, (Vec3d{1, 2, 3})) << "not before update()";
  EXPECT_EQ(updated(pose), (std::vector<std::uint32_t>{1, 2}));
  EXPECT_EQ(pose.world(2).translation, (Vec3d{1, 5, 6}));
  EXPECT_EQ(pose.world(3).translation, (Vec3d{9, 9, 9}));
  EXPECT_TRUE(updated(pose).empty());
}

TEST(ScenePose, WhatIsSetToWhereItIsHasNotMoved) {
  const Scene scene = chain();
  ScenePose pose(scene);
  pose.set_local(0, scene.nodes[0].local);
  EXPECT_TRUE(updated(pose).empty());
}

TEST(ScenePose, MovesByVectorsOfTheWorld) {
  Scene scene = chain();
  // The parent turns x to y and doubles.
  scene.nodes[0].local = Affine{{Vec3d{0, 2, 0}, Vec3d{-2, 0, 0}, Vec3d{0, 0, 2}}, {1, 0, 0}};
  ScenePose pose(scene);
  const Vec3d before = pose.world(2).translation;
  pose.move(2, {1, 2, 3});
  EXPECT_EQ(updated(pose), (std::vector<std::uint32_t>{2}));
  EXPECT_LT(length(pose.world(2).translation - before - Vec3d{1, 2, 3}), 1e-12);
  pose.move(0, {5, 0, 0});
  EXPECT_EQ(updated(pose), (std::vector<std::uint32_t>{0, 1, 2}));
  EXPECT_LT(length(pose.world(2).translation - before - Vec3d{6, 2, 3}), 1e-12);
}

TEST(ScenePose, FollowsAClip) {
  Scene scene = chain();
  SceneChannel channel;
  channel.node = 0, channel.times_s = {0, 2}, channel.values = {1, 0, 0, 5, 0, 0};
  scene.clips = {{"slide", {channel}}};
  ScenePose pose(scene);
  pose.set_clip_time(0, 1);
  EXPECT_EQ(updated(pose), (std::vector<std::uint32_t>{0, 1, 2}));
  EXPECT_NEAR(pose.world(2).translation.x, 3, 1e-12);
  pose.set_clip_time(0, 7);
  updated(pose);
  EXPECT_NEAR(pose.world(2).translation.x, 5, 1e-12);
  pose.set_clip_time(0, 9);
  EXPECT_TRUE(updated(pose).empty()) << "the clip has ended";
}

}  // namespace
}  // namespace cuesta::test
