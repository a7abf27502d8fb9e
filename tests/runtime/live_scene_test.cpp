#include "runtime/live_scene.h"

#include "tests/runtime/small_scene.h"

namespace cuesta::test {
namespace {

/// A row of balls along -z, 3 apart, seen from its near end.
std::unique_ptr<SmallScene> row(std::uint32_t count) {
  auto scene = std::make_unique<SmallScene>();
  const std::uint32_t part = scene->add_part(bumpy_ball(40, 60));
  for (std::uint32_t i = 0; i < count; ++i) scene->add_node(part, {0, 0, -3.0 * i});
  return scene;
}

View from_front(double z = 4) {
  View view;
  view.eye = {0.3, 0.4, z}, view.target = {0, 0, 0}, view.width_px = 320, view.height_px = 240;
  return view;
}

double fake_now = 0;
std::unique_ptr<LiveScene> open(SmallScene& scene, SceneSettings settings = {}, std::uint32_t threads = 0) {
  settings.load_threads = threads;
  return LiveScene::open(scene.directory, {scene.reader(), {}}, settings, [] { return fake_now += 0.001; })
      .value();
}

std::uint64_t triangles_in(const SceneDrawList& list) {
  std::uint64_t sum = 0;
  for (const DrawnGroup& g : list.groups) sum += g.count * g.indices->triangles.size();
  return sum;
}

TEST(LiveScene, DrawsAllThatIsVisible) {
  const auto scene = row(10);
  const auto live = open(*scene);
  SceneFrameOptions options;
  options.uniform = 1, options.tau_px = 1e-6, options.least_px = 0;
  const auto report = live->settle(from_front(), options);
  EXPECT_EQ(report.visible_objects, 10u);
  EXPECT_EQ(report.drawn_objects, 10u);
  EXPECT_EQ(report.visible_triangles, 10 * scene->toms[0].triangles.size());
  EXPECT_EQ(report.drawn_triangles, report.visible_triangles);
  EXPECT_EQ(triangles_in(live->list()), report.drawn_triangles);
  ASSERT_EQ(live->list().groups.size(), 1u) << "one part at one resolution";
  EXPECT_EQ(live->list().groups[0].indices->resolution, scene->toms[0].full());
}

TEST(LiveScene, LeavesOutWhatIsBehindAndWhatIsTiny) {
  const auto scene = row(10);
  const auto live = open(*scene);
  SceneFrameOptions options;
  View away = from_front();
  away.target = {0, 0, 9};
  EXPECT_EQ(live->settle(away, options).visible_objects, 0u);
  options.least_px = 60;
  const auto few = live->settle(from_front(), options).visible_objects;
  EXPECT_GT(few, 0u);
  EXPECT_LT(few, 5u);
}

TEST(LiveScene, DrawsWhatIsThereWhileMoreIsComing) {
  const auto scene = row(3);
  const auto live = open(*scene);
  SceneFrameOptions options;
  options.tau_px = 1e-3;
  std::uint64_t last = 0;
  EXPECT_EQ(live->frame(from_front(), options).drawn_objects, 0u);
  for (int i = 0; i < 6; ++i) {
    const auto report = live->frame(from_front(), options);
    EXPECT_EQ(report.drawn_objects, 3u) << i;
    EXPECT_GE(report.drawn_triangles, last) << i;
    last = report.drawn_triangles;
  }
  EXPECT_GT(last, 1000u);
}

/// A loader that never comes back: frames go on.
TEST(LiveScene, NoFrameWaitsForAPart) {
  const auto scene = row(3);
  std::atomic<bool> let_go{false};
  const PrefixReader good = scene->reader();
  const PrefixReader slow = [&](std::uint32_t part, const Tom* have, std::uint32_t a, std::uint32_t b) {
    while (b > 1 && !let_go) std::this_thread::sleep_for(std::chrono::milliseconds(1));
    return good(part, have, a, b);
  };
  SceneSettings settings;
  settings.load_threads = 1;
  const auto live =
      LiveScene::open(scene->directory, {slow, {}}, settings, [] { return fake_now += 0.001; }).value();
  SceneFrameOptions options;
  options.tau_px = 1e-3;
  SceneFrameReport report;
  while (report.drawn_objects < 3) {
    report = live->frame(from_front(), options);
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }
  for (int i = 0; i < 50; ++i) report = live->frame(from_front(), options);
  EXPECT_EQ(report.drawn_objects, 3u);
  EXPECT_GT(report.store.missing, 0u);
  let_go = true;
  EXPECT_GT(live->settle(from_front(), options).drawn_triangles, report.drawn_triangles);
}

TEST(LiveScene, APartThatMovesIsDrawnWhereItIs) {
  const auto scene = row(2);
  const auto live = open(*scene);
  SceneFrameOptions options;
  live->settle(from_front(), options);
  live->pose().set_local(1, Trs{{500, 0, 0}, {0, 0, 0, 1}, {1, 1, 1}});
  EXPECT_EQ(live->frame(from_front(), options).visible_objects, 1u);
  live->pose().set_local(1, Trs{{-1, 0, 0}, {0, 0, 0, 1}, {-1, 1, 1}});
  EXPECT_EQ(live->frame(from_front(), options).visible_objects, 2u);
  const SceneDrawList list = live->list();
  std::uint32_t mirrored = 0;
  for (const DrawnGroup& g : list.groups)
    for (std::uint32_t i = 0; i < g.count; ++i) {
      const Affine& world = list.instances[g.first + i].world;
      EXPECT_EQ(g.mirrored, determinant(world) < 0);
      mirrored += g.mirrored ? 1 : 0;
    }
  EXPECT_EQ(mirrored, 1u);
  EXPECT_NEAR(live->bounds().lo.x, -2.0, 0.06);
}

/// A machine that takes 1 ms, 2 µs for a triangle; the scene's own costs are learned.
double machine_ms(const FrameWork& w) {
  return 1 + 0.02 * w.objects + 2e-3 * w.triangles;
}

std::vector<double> fly(LiveScene& live, double deadline_ms, int frames) {
  SceneFrameOptions options;
  options.deadline_ms = deadline_ms, options.tau_px = 0.01;
  std::vector<double> ms;
  for (int i = 0; i < frames; ++i) {
    View view = from_front(4 + 12 * std::sin(0.07 * i));
    view.target = {0, 0, view.eye.z - 1};
    live.frame(view, options);
    ms.push_back(machine_ms(live.work()));
    live.measured(ms.back());
  }
  return ms;
}

TEST(LiveScene, PredictiveHoldsTheDeadline) {
  const auto scene = row(40);
  const auto live = open(*scene);
  fly(*live, 15, 100);
  int late = 0;
  double used = 0;
  for (const double ms : fly(*live, 15, 400)) late += ms > 15 ? 1 : 0, used += ms / 400;
  EXPECT_LE(late, 4);
  EXPECT_GT(used, 9);
}

/// A machine whose frames take as long as their fragments: a tenth of the bounds, and 16 with each triangle.
TEST(LiveScene, LearnsWhatPartsFillOfTheirBounds) {
  const auto scene = row(10);
  const auto live = open(*scene);
  SceneFrameOptions options;
  options.tau_px = 0.01, options.deadline_ms = 40;
  double error = 0, late = 0;
  std::vector<CallFill> fill;
  for (int i = 0; i < 60; ++i) {
    View view = from_front(4 + 3 * std::sin(0.3 * i));
    const auto report = live->frame(view, options);
    const double bounds = live->work().fragments;
    if (i == 0) {
      EXPECT_GT(bounds, 320 * 240 * 0.3) << "of a ball that fills the picture, nothing known yet";
    }
    fill.clear();
    const ViewCone cone(view);
    for (const DrawnGroup& g : live->list().groups) {
      double sum = 0;
      for (std::uint32_t k = 0; k < g.count; ++k)
        sum += cone.footprint(live->ball(live->list().instances[g.first + k].instance)).coverage;
      const double triangles = double(g.count) * double(g.indices->triangles.size());
      fill.push_back({static_cast<float>(0.1 * sum * 320 * 240 + 16 * triangles), 0});
    }
    live->drew(fill);
    const double ms = 1 + 5e-4 * live->work().fragments + 1e-3 * live->work().triangles;
    live->measured(ms + report.choice_ms);
    if (i < 30) continue;
    error = std::max(error, std::abs(ms / report.predicted_ms - 1));
    late += ms > 40 ? 1 : 0;
  }
  EXPECT_LT(error, 0.05);
  EXPECT_EQ(late, 0);
}

TEST(LiveScene, PixelsAreThoseOfTheLastFrame) {
  const auto scene = row(3);
  const auto live = open(*scene);
  live->settle(from_front(), {});
  EXPECT_EQ(live->work().pixels, 0);
  live->drew(std::vector<CallFill>(live->list().groups.size(), CallFill{100, 7}));
  const double written = 7.0 * double(live->list().groups.size());
  EXPECT_EQ(live->work().pixels, written);
  EXPECT_EQ(live->guess().pixels, 0) << "as it was known before";
  live->frame(from_front(), {});
  EXPECT_EQ(live->guess().pixels, written);
}

TEST(LiveScene, WhatLooksLargestIsDrawnFirst) {
  SmallScene scene;
  const std::uint32_t parts[] = {scene.add_part(bumpy_ball(40, 60)), scene.add_part(bumpy_ball(20, 30)),
                                 scene.add_part(bumpy_ball(30, 40))};
  for (const double z : {-9.0, 0.0, -3.0, -6.0}) scene.add_node(parts[0], {0, 0, z});
  scene.add_node(parts[1], {1, 0, 2});
  scene.add_node(parts[2], {0, 1, -4.5});
  const auto live = open(scene);
  SceneFrameOptions options;
  options.uniform = 1, options.least_px = 0;
  const View view = from_front();
  live->settle(view, options);
  const SceneDrawList list = live->list();
  const auto distance_radii = [&](std::uint32_t drawn) {
    const Ball& ball = live->ball(list.instances[drawn].instance);
    return length(ball.centre - view.eye) / ball.radius;
  };
  ASSERT_GE(list.groups.size(), 3u);
  for (std::size_t i = 1; i < list.groups.size(); ++i)
    EXPECT_LE(distance_radii(list.groups[i - 1].first), distance_radii(list.groups[i].first)) << i;
  for (const DrawnGroup& g : list.groups)
    for (std::uint32_t k = g.first + 1; k < g.first + g.count; ++k)
      EXPECT_LE(distance_radii(k - 1), distance_radii(k)) << k;
}

TEST(PartFill, BlendsWhatWasMeasured) {
  PartFill fill(3);
  EXPECT_EQ(fill.share(1), 1);
  fill.add(1, 10, 100);
  fill.add(1, 30, 100);
  fill.learn();
  EXPECT_FLOAT_EQ(static_cast<float>(fill.share(1)), 0.2f);
  EXPECT_FLOAT_EQ(static_cast<float>(fill.share(2)), 0.2f) << "as all others";
  fill.add(1, 40, 100);
  fill.add(2, 0, 0);
  fill.learn();
  EXPECT_FLOAT_EQ(static_cast<float>(fill.share(1)), 0.3f);
}

TEST(LiveScene, NearerAndHeavierObjectsGetMore) {
  const auto scene = row(12);
  const auto live = open(*scene);
  SceneFrameOptions options;
  options.deadline_ms = 8, options.tau_px = 1e-3;
  live->set_weight(11, 400);
  const auto triangles_at = [&](double z) {
    const SceneDrawList list = live->list();
    for (const DrawnGroup& g : list.groups)
      for (std::uint32_t i = 0; i < g.count; ++i)
        if (list.instances[g.first + i].world.translation.z == z) return g.indices->triangles.size();
    return std::size_t{0};
  };
  for (int i = 0; i < 30; ++i) {
    live->frame(from_front(), options);
    live->measured(machine_ms(live->work()));
  }
  EXPECT_GT(triangles_at(0), triangles_at(-18));
  EXPECT_GT(triangles_at(-33), triangles_at(-30));
}

TEST(LiveScene, ATightCacheCostsQualityNotObjects) {
  const auto scene = std::make_unique<SmallScene>();
  for (std::uint32_t i = 0; i < 12; ++i)
    scene->add_node(scene->add_part(bumpy_ball(30 + i, 40)), {0, 0, -3.0 * i});
  SceneSettings settings;
  settings.cache_bytes = bytes_of_all(*scene) / 4;
  const auto live = open(*scene, settings, 2);
  SceneFrameOptions options;
  options.deadline_ms = 1000, options.tau_px = 1e-3, options.least_px = 0;
  const auto report = live->settle(from_front(), options, 200);
  EXPECT_EQ(report.drawn_objects, 12u);
  EXPECT_LE(report.store.resident_bytes, settings.cache_bytes);
  EXPECT_LT(report.drawn_triangles, report.visible_triangles);
}

}  // namespace
}  // namespace cuesta::test
