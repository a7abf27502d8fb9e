/// What is under the pointer in a scene, and what is told about its frames.

#include <algorithm>
#include <limits>

#include "apps/scene_show/part_ray.h"
#include "apps/scene_show/scene_statistics.h"
#include "apps/view/ray.h"
#include "tests/runtime/small_scene.h"

namespace cuesta::test {
namespace {

using scene_show::part_along;

/// Balls at 0, at -5 on z mirrored and twice as large, and at 4 on x.
struct Balls {
  SmallScene scene;
  std::unique_ptr<LiveScene> live;
  double now = 0;

  Balls() {
    const std::uint32_t part = scene.add_part(bumpy_ball(40, 60));
    for (const Vec3d at : {Vec3d{0, 0, 0}, Vec3d{0, 0, -5}, Vec3d{4, 0, 0}}) scene.add_node(part, at);
    scene.directory.scene.nodes[1].local = Trs{{0, 0, -5}, {0, 0, 0, 1}, {-2, 2, 2}};
    SceneSettings settings;
    settings.load_threads = 0;
    live = LiveScene::open(scene.directory, {scene.reader(), {}}, settings, [this] {
             return now += 0.01;
           }).value();
    View view;
    view.eye = {0, 0, 20};
    SceneFrameOptions options;
    options.uniform = 1, options.tau_px = 1e-6;
    live->settle(view, options);
  }
};

/// As a search over all triangles of all parts.
std::optional<scene_show::PartHit> slow_part_along(const Balls& b, Vec3d origin, Vec3d direction) {
  scene_show::PartHit hit{0, std::numeric_limits<double>::infinity()};
  const Tom& tom = b.scene.toms[0];
  for (std::uint32_t i = 0; i < 3; ++i) {
    const Affine& world = b.live->pose().world(b.live->instances()[i].node);
    const auto at = [&](std::uint32_t v) {
      return world.point(tom.origin + vec_cast<double>(tom.positions[v]));
    };
    for (const Triangle& t : tom.triangles)
      if (const double d = view::Ray{origin, direction}.distance(at(t[0]), at(t[1]), at(t[2]));
          d < hit.distance)
        hit = {i, d};
  }
  if (!std::isfinite(hit.distance)) return {};
  return hit;
}

TEST(PartRay, FindsTheNearestPart) {
  Balls b;
  EXPECT_EQ(part_along(*b.live, {0, 0, 20}, {0, 0, -1})->instance, 0u);
  EXPECT_EQ(part_along(*b.live, {0, 0, -20}, {0, 0, 1})->instance, 1u);
  EXPECT_EQ(part_along(*b.live, {4, 0, 20}, {0, 0, -1})->instance, 2u);
  EXPECT_FALSE(part_along(*b.live, {8, 0, 20}, {0, 0, -1}));
  EXPECT_FALSE(part_along(*b.live, {0, 0, 20}, {0, 0, 1})) << "behind";
  b.live->pose().move(2, {0, 3, 0});
  View view;
  view.eye = {0, 0, 20};
  b.live->settle(view, {});
  EXPECT_FALSE(part_along(*b.live, {4, 0, 20}, {0, 0, -1})) << "it has moved";
}

TEST(PartRay, IsWhatASearchOverAllTrianglesFinds) {
  Balls b;
  std::uint32_t met = 0;
  for (int i = 0; i < 400; ++i) {
    const Vec3d origin{std::sin(i * 0.7) * 7, std::cos(i * 1.1) * 5, std::sin(i * 0.3) * 12};
    const Vec3d aim{std::cos(i * 2.3) * 3, std::sin(i * 1.7), std::sin(i * 2.9) * 4};
    const Vec3d direction = normalized(aim - origin);
    const auto fast = part_along(*b.live, origin, direction), slow = slow_part_along(b, origin, direction);
    ASSERT_EQ(fast.has_value(), slow.has_value()) << i;
    if (!fast) continue;
    ++met;
    EXPECT_EQ(fast->instance, slow->instance) << i;
    EXPECT_NEAR(fast->distance, slow->distance, 1e-9 * slow->distance) << i;
  }
  EXPECT_GT(met, 40u);
}

TEST(SceneStatistics, TellTimesAndTriangles) {
  scene_show::SceneStatistics s;
  s.title = "engine.cuesta";
  s.frame.actual_ms = 31.24;
  SceneFrameReport& r = s.frame.report;
  r.desired_ms = 33, r.predicted_ms = 30, r.optimisation_ms = 0.25, r.choice_ms = 1.5;
  r.drawn_triangles = 12345, r.visible_triangles = 1234567, r.store.missing = 3;
  s.clip = {"turn", 1.25, 4, false};
  const auto lines = scene_show::statistics_lines(s);
  const auto has = [&](const std::string& line) {
    return std::find(lines.begin(), lines.end(), line) != lines.end();
  };
  EXPECT_TRUE(has("time       31.2 ms, desired 33, predicted 30.0"));
  EXPECT_TRUE(has("choice     1.50 ms, optimisation 0.25"));
  EXPECT_TRUE(has("triangles  12,345 of 1,234,567 visible"));
  EXPECT_TRUE(has("clip       turn, 1.2 of 4.0 s, held"));
  s.clip.reset();
  EXPECT_EQ(scene_show::statistics_lines(s).size() + 1, lines.size());
}

}  // namespace
}  // namespace cuesta::test
