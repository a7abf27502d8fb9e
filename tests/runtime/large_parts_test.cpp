/// A scene of one large part, which is a fan-hierarchy in the scene's file, and of TOMs: chosen together,
/// within a triangle budget, and drawn as in full.

#include <tbb/global_control.h>

#include "hierarchy/build_scene.h"
#include "ooc/mesh_writer.h"
#include "runtime/draw/picture_compare.h"
#include "runtime/draw/scene_renderer.h"
#include "runtime/scene_sources.h"
#include "tests/hierarchy/built_file.h"
#include "tests/runtime/small_scene.h"

namespace cuesta::test {
namespace {

constexpr double nearest = 1e-4;

SceneRenderer& renderer() {
  static const auto made = SceneRenderer::create(make_osmesa_context().value()).value();
  return *made;
}

View front_view() {
  View view;
  view.eye = {0, 0.5, 4.5}, view.target = {0, 0, 0}, view.width_px = 240, view.height_px = 180;
  return view;
}

/// A ball of 43,200 triangles in the middle, balls of 2,240 about it.
class LargeParts : public testing::Test {
 protected:
  static void SetUpTestSuite() {
    folder = new TemporaryFolder;
    std::filesystem::create_directories(*folder / "in");
    ASSERT_TRUE(write_mesh(*folder / "in/0_large.ply", bumpy_ball(109, 200)));
    for (int i = 0; i < 5; ++i) {
      SurfaceMesh small = bumpy_ball(29, 40);
      const double turn = 2 * std::numbers::pi * i / 5;
      for (Vec3d& p : small.positions)
        p = p * 0.3 + Vec3d{1.6 * std::cos(turn), 1.6 * std::sin(turn), 0.01 * i};
      ASSERT_TRUE(write_mesh(*folder / ("in/" + std::to_string(i + 1) + ".ply"), small));
    }
    auto source = open_scene(*folder / "in", std::uint64_t{64} << 20);
    ASSERT_TRUE(source) << source.error().text();
    auto work = WorkFolder::open((*folder / "a.work").string(), "test");
    ASSERT_TRUE(work);
    MemoryBudget memory(std::uint64_t{1} << 30);
    SceneBuildOptions options;
    options.largest_tom = 10000, options.cell_triangles = 4096;
    const auto built = build_scene(**source, *folder / "a.cuesta", options, *work, memory, {});
    ASSERT_TRUE(built) << built.error().text();
    ASSERT_EQ(built->surfaces, 1u);
    ASSERT_EQ(built->toms, 5u);
  }
  static void TearDownTestSuite() { delete folder; }

  void SetUp() override {
    file_.emplace(SceneFile::open(*folder / "a.cuesta").value());
    const Clock clock = [] { return 0.0; };  // no time passes: the same choice each time
    SceneSettings settings;
    settings.load_threads = 0;
    live_ = LiveScene::open(file_->directory(), sources_of(*file_, clock, 0), settings, clock).value();
    // A machine on which a triangle takes a microsecond, and nothing else any time to speak of.
    std::vector<MeasuredFrame> measured;
    for (int i = 1; i <= 40; ++i) {
      const FrameWork work{double(1 + i % 6), 1000.0 * i, 1000.0 * (i % 3), 100.0 * (i % 7), 50.0 * (i % 5)};
      measured.push_back({work, 1e-3 * work.triangles + 1e-4});
    }
    live_->calibrate(measured);
  }
  /// As one budget of triangles would have it.
  SceneFrameOptions budget(double triangles) const {
    SceneFrameOptions options;
    options.deadline_ms = 1e-3 * triangles, options.tau_px = 0.01, options.least_px = 0;
    options.change_share = 10;  // what is to be sent is no matter of these tests
    return options;
  }
  SceneFrameReport settle(const View& view, const SceneFrameOptions& options) {
    SceneFrameReport report = live_->settle(view, options);
    for (int i = 0; i < 100 && !report.settled; ++i) report = live_->settle(view, options);
    EXPECT_TRUE(report.settled);
    return report;
  }
  static std::uint64_t surface_triangles(const LiveScene& live) {
    std::uint64_t sum = 0;
    for (const DrawnSurface& s : live.list().surfaces)
      for (const Range& range : s.list.draws) sum += range.count / 3;
    return sum;
  }
  Picture draw(const View& view, Shading shading = Shading::lit) {
    DrawOptions look;
    look.shading = shading, look.surface_colour = {255, 255, 255, 255};
    const auto drawn = renderer().draw(live_->list(), view, nearest, look);
    EXPECT_TRUE(drawn);
    return renderer().read().value();
  }

  static TemporaryFolder* folder;
  std::optional<SceneFile> file_;
  std::unique_ptr<LiveScene> live_;
};

TemporaryFolder* LargeParts::folder = nullptr;

TEST_F(LargeParts, ABudgetHoldsForAllPartsTogether) {
  for (const double triangles : {4000.0, 10000.0, 25000.0}) {
    const auto report = settle(front_view(), budget(triangles));
    EXPECT_EQ(report.drawn_objects, 6u);
    EXPECT_EQ(report.outcome, ResolutionOutcome::optimal) << triangles;
    EXPECT_LE(report.drawn_triangles, triangles);
    EXPECT_GE(report.drawn_triangles, 0.6 * triangles) << "it is used";
    EXPECT_GT(surface_triangles(*live_), 0.2 * triangles) << "the part in the middle gets its share";
    EXPECT_LT(surface_triangles(*live_), report.drawn_triangles);
  }
}

TEST_F(LargeParts, NoFrameOfAFlightIsAboveTheBudget) {
  View view = front_view();
  settle(view, budget(12000));
  for (int i = 0; i < 60; ++i) {
    view.eye = {3 * std::sin(0.1 * i), 0.5, 2 + 2.5 * std::cos(0.13 * i)};
    EXPECT_LE(live_->frame(view, budget(12000)).drawn_triangles, 12000u) << i;
  }
}

TEST_F(LargeParts, WithinABudgetItLooksAsInFull) {
  SceneFrameOptions full = budget(1e6);
  full.uniform = 1, full.tau_px = 1e-3;
  const auto all = settle(front_view(), full);
  EXPECT_GE(static_cast<double>(all.drawn_triangles), 0.97 * static_cast<double>(all.visible_triangles));
  const Picture fine = draw(front_view());
  const auto some = settle(front_view(), budget(16000));
  EXPECT_LT(some.drawn_triangles, all.drawn_triangles / 3);
  const auto difference = compare(fine, draw(front_view()));
  EXPECT_GE(difference.fraction_within(16), 0.93);
  EXPECT_GE(difference.ssim, 0.91);
}

TEST_F(LargeParts, LargePartsMoveAsOthersDo) {
  const SceneFrameOptions options = budget(1e6);
  settle(front_view(), options);
  const Picture before = draw(front_view(), Shading::normals);
  for (const SceneInstance& in : live_->instances()) live_->pose().move(in.node, {0.5, 0, 0});
  View moved = front_view();
  moved.eye.x += 0.5, moved.target.x += 0.5;
  settle(moved, options);
  EXPECT_GE(compare(before, draw(moved, Shading::normals)).fraction_within(8), 0.985);
}

}  // namespace
}  // namespace cuesta::test
