/// adapt(): cost follows change, budgets are hard, pages come when they come, and a camera at rest does not
/// tell how it came there.

#include <gtest/gtest.h>

#include <array>
#include <cmath>

#include "tests/runtime/corner_map.h"
#include "tests/runtime/open_file.h"

namespace cuesta::test {
namespace {

using State = std::vector<std::tuple<PageId, std::uint32_t, std::uint16_t>>;

/// Fans that are not wholly applied, and how far they are: equal where the cuts are.
State state_of(const Cut& cut) {
  State state;
  for (const PageId id : cut.cache().resident_ids()) {
    const ResidentPage& page = *cut.cache().resident(id);
    for (std::uint32_t f = 0; f < page.fans().size(); ++f)
      if (page.fans()[f].applied < page.fans()[f].child_count)
        state.push_back({id, f, page.fans()[f].applied});
  }
  return state;
}

class Adapt : public testing::Test {
 protected:
  void SetUp() override { build_file(bumpy_sphere(48), folder_ / "a.cuesta"); }
  std::unique_ptr<Cut> open(std::uint64_t cache = unlimited, std::uint32_t threads = 0) {
    auto cut = Cut::open(
        CuestaFile::open(folder_ / "a.cuesta").value(), cache, [] { return 0.0; }, threads);
    return cut ? std::move(*cut) : nullptr;
  }
  std::pair<std::uint64_t, std::uint64_t> resident_range() {
    const auto cut = open();
    const std::uint64_t base = cut->cache().resident_bytes();
    return {base, cut->settle(ErrorScale::uniform(cut->directory().grid), -1, {}).resident_bytes};
  }
  TemporaryFolder folder_;
};

AdaptReport adapt_until_rest(Cut& cut, const ErrorScale& scale, double tau, const Budgets& budgets) {
  AdaptReport report;
  for (int i = 0; i < 5000 && !report.settled; ++i) {
    report = cut.adapt(scale, tau, budgets);
    if (report.pages_missing > 0) cut.cache().wait();
  }
  return report;
}

TEST_F(Adapt, a_still_camera_costs_nothing) {
  const auto cut = open();
  std::mt19937 random(1);
  const ErrorScale scale =
      ErrorScale::perspective(cut->directory().grid, random_view(cut->directory(), random));
  ASSERT_TRUE(adapt_until_rest(*cut, scale, 1, {}).settled);
  const auto loads = cut->cache().counters().loads;
  for (int i = 0; i < 100; ++i) {
    const auto report = cut->adapt(scale, 1, {});
    EXPECT_EQ(report.blocks_tested + report.coarse_operations + report.fine_operations + report.upload_bytes,
              0u);
    EXPECT_TRUE(report.settled);
  }
  EXPECT_EQ(cut->cache().counters().loads, loads);
}

/// Slack: after many small steps the cut is the one that testing every fan gives.
TEST_F(Adapt, small_steps_leave_nothing_out) {
  const auto cut = open();
  cut->set_path_policy(PathPolicy::always_fine);
  std::mt19937 random(2);
  std::uint64_t tested = 0, frames = 0;
  for (int leg = 0; leg < 6; ++leg) {
    View view = random_view(cut->directory(), random);
    const Vec3d step = (random_view(cut->directory(), random).eye - view.eye) / 400.0;
    const double tau = 0.3 + 0.3 * leg;
    cut->settle(ErrorScale::perspective(cut->directory().grid, view, 4), tau, {});
    for (int i = 0; i < 60; ++i, ++frames) {
      view.eye = view.eye + step;
      const ErrorScale scale = ErrorScale::perspective(cut->directory().grid, view, 4);
      tested += cut->adapt(scale, tau, {}).blocks_tested;
      const auto fresh = i % 20 == 19 ? open() : nullptr;
      if (!fresh) continue;
      fresh->settle(scale, tau, {});
      ASSERT_EQ(state_of(*cut), state_of(*fresh)) << "leg " << leg << " step " << i;
    }
  }
  std::uint64_t blocks = 0;
  for (const PageId id : cut->cache().resident_ids())
    blocks += (cut->cache().resident(id)->fans().size() + ActiveNodes::block - 1) / ActiveNodes::block;
  EXPECT_LT(tested, frames * blocks / 2) << "slack saves nothing";
}

/// From wherever, with whatever budgets binding, and with threads that load in any order.
TEST_F(Adapt, at_rest_the_cut_is_a_fresh_start_s) {
  const auto [base, all] = resident_range();
  std::mt19937 random(3);
  for (const std::uint32_t threads : {0u, 2u}) {
    for (int round = 0; round < 8; ++round) {
      Budgets budgets;
      if (round % 2) budgets.triangles = 900 + random() % 2000;
      const std::uint64_t cache = round % 4 < 2 ? unlimited : base + (all - base) / (2 + random() % 3);
      const auto travelled = open(cache, threads);
      for (int i = 0; i < 60; ++i)
        travelled->adapt(ErrorScale::perspective(travelled->directory().grid,
                                                 random_view(travelled->directory(), random), 4),
                         0.2, budgets);
      const ErrorScale last = ErrorScale::perspective(travelled->directory().grid,
                                                      random_view(travelled->directory(), random), 4);
      const auto report = adapt_until_rest(*travelled, last, 0.2, budgets);
      ASSERT_TRUE(report.settled) << "round " << round;
      const auto fresh = open(cache, threads);
      const auto expected = adapt_until_rest(*fresh, last, 0.2, budgets);
      ASSERT_TRUE(expected.settled);
      EXPECT_EQ(state_of(*travelled), state_of(*fresh)) << "round " << round << ", threads " << threads;
      EXPECT_EQ(report.tau, expected.tau);
      EXPECT_EQ(report.triangles, expected.triangles);
      EXPECT_LE(report.triangles, budgets.triangles);
    }
  }
}

TEST_F(Adapt, uploads_stay_in_their_budget) {
  const auto cut = open(unlimited, 1);
  cut->draw_list();  // has the base page
  std::mt19937 random(4);
  for (int i = 0; i < 300; ++i) {
    Budgets budgets;
    budgets.upload_bytes = 32000 + random() % 40000;
    const ErrorScale scale =
        ErrorScale::perspective(cut->directory().grid, random_view(cut->directory(), random));
    const auto report = cut->adapt(scale, 0.2, budgets);
    const DrawList list = cut->draw_list();
    std::uint64_t bytes = 0;
    for (const Range& r : list.changed_vertices) bytes += r.count * sizeof(DrawVertex);
    for (const Range& r : list.changed_indices) bytes += r.count * sizeof(std::uint32_t);
    ASSERT_LE(bytes, report.upload_bytes) << "frame " << i;
    ASSERT_LE(report.upload_bytes, budgets.upload_bytes) << "frame " << i;
    if (i % 10 == 0) cut->cache().wait();
  }
  EXPECT_GT(cut->cache().resident_ids().size(), 1u);
}

/// Whatever mix of paths a flight takes, the cut is legal in every frame.
TEST_F(Adapt, any_mix_of_paths_is_legal) {
  const auto cut = open();
  cut->settle(ErrorScale::uniform(cut->directory().grid), -1, {});
  const Slots full = drawn_triangles(*cut);
  std::mt19937 random(5);
  std::uint64_t coarse = 0, fine = 0;
  for (int leg = 0; leg < 20; ++leg) {
    View view = random_view(cut->directory(), random);
    const Vec3d step = (random_view(cut->directory(), random).eye - view.eye) / (leg % 2 ? 400.0 : 20.0);
    cut->set_path_policy(leg % 5 == 0   ? PathPolicy::always_coarse
                         : leg % 5 == 1 ? PathPolicy::always_fine
                                        : PathPolicy::by_motion);
    for (int i = 0; i < 15; ++i) {
      view.eye = view.eye + step;
      const auto report = cut->adapt(ErrorScale::perspective(cut->directory().grid, view, 4), 0.5, {});
      coarse += report.coarse_operations;
      fine += report.fine_operations;
      ASSERT_EQ(drawn_triangles(*cut), mapped_triangles(*cut, full)) << "leg " << leg << " frame " << i;
      ASSERT_LE(cut->achieved(ErrorScale::perspective(cut->directory().grid, view, 4)), 0.5);
    }
  }
  EXPECT_GT(coarse, 0u);
  EXPECT_GT(fine, 0u);
}

/// Coarser where the surface faces eye and light, never finer, always legal, and at rest the same from
/// everywhere.
TEST_F(Adapt, visual_error_is_legal_and_saves_triangles) {
  build_file(wavy_patch(100), folder_ / "flat.cuesta");
  const auto open_flat = [&] { return open_cut(folder_ / "flat.cuesta"); };
  const auto plain = open_flat(), visual = open_flat();
  const Directory& d = plain->directory();
  VisualError error{4, Vec3d{0, 0, 1}};
  visual->set_visual_error(error);
  visual->settle(ErrorScale::uniform(d.grid), -1, {});
  const Slots full = drawn_triangles(*visual);
  std::mt19937 random(9);
  std::uint64_t with = 0, without = 0;
  for (int i = 0; i < 30; ++i) {
    const ErrorScale scale = ErrorScale::perspective(d.grid, random_view(d, random), 4);
    visual->adapt(scale, 0.5, {});
    ASSERT_EQ(drawn_triangles(*visual), mapped_triangles(*visual, full)) << "view " << i;
    visual->settle(scale, 0.5, {});
    ASSERT_EQ(drawn_triangles(*visual), mapped_triangles(*visual, full)) << "view " << i;
    with += visual->cache().pool().active_triangles();
    without += plain->settle(scale, 0.5, {}).triangles;
    const auto fresh = open_flat();
    fresh->set_visual_error(error);
    fresh->settle(scale, 0.5, {});
    ASSERT_EQ(state_of(*visual), state_of(*fresh)) << "view " << i;
  }
  EXPECT_LT(with, without);
}

TEST(VisualError, by_hand) {
  const std::array<Vec3f, 3> up{Vec3f{0, 0, 1}, {0, 0, 1}, {0, 0, 1}};
  const NormalCone flat = NormalCone::around(up);
  const Sphere ball{{0, 0, 0}, 1};
  const VisualError eye_only{4, {}};
  EXPECT_EQ(eye_only.page_factor(flat, ball, {0, 0, 1e6}), std::pow(1.25, 6));  // 3.81, the last below 4
  EXPECT_EQ(eye_only.page_factor(flat, ball, {0, 0, -1e6}), std::pow(1.25, 6));
  EXPECT_EQ(eye_only.page_factor(flat, ball, {1e6, 0, 0}), 1);                          // a silhouette
  EXPECT_EQ(eye_only.page_factor(flat, ball, {0, 0, 0.5}), 1);                          // the eye in the ball
  EXPECT_EQ((VisualError{4, Vec3d{1, 0, 0}}.page_factor(flat, ball, {0, 0, 1e6})), 1);  // grazing light
  const std::array<Vec3f, 2> wide{Vec3f{1, 0, 0}, {-1, 0, 0.01f}};
  EXPECT_EQ(eye_only.page_factor(NormalCone::around(wide), ball, {0, 0, 1e6}), 1);
}

TEST_F(Adapt, tests_in_parallel_move_the_same) {
  const auto one = open(), many = open();
  many->set_parallel(true);
  std::mt19937 random(8);
  for (int i = 0; i < 60; ++i) {
    Budgets budgets;
    if (i % 3 == 0) budgets.triangles = 2000;
    const ErrorScale scale =
        ErrorScale::perspective(one->directory().grid, random_view(one->directory(), random), 4);
    const auto a = one->adapt(scale, 0.3, budgets), b = many->adapt(scale, 0.3, budgets);
    ASSERT_EQ(state_of(*one), state_of(*many)) << "frame " << i;
    ASSERT_EQ(a.blocks_tested, b.blocks_tested);
  }
}

/// The file is overwritten, cut short and removed while threads read it: coarser pictures and messages, no
/// holes.
TEST_F(Adapt, a_file_that_is_damaged_during_a_flight) {
  for (const bool cut_short : {false, true}) {
    SetUp();
    const auto cut = open(unlimited, 2);
    std::mt19937 random(6);
    for (int i = 0; i < 200; ++i) {
      if (i == 3) {
        std::string bytes = bytes_of(folder_ / "a.cuesta");
        if (cut_short)
          std::filesystem::resize_file(folder_ / "a.cuesta", bytes.size() / 3);
        else
          for (std::size_t k = bytes.size() / 10; k < bytes.size(); k += 100) bytes[k] ^= 1;
        if (!cut_short) put_bytes(folder_ / "a.cuesta", bytes);
      }
      cut->adapt(ErrorScale::perspective(cut->directory().grid, random_view(cut->directory(), random)), 0.2,
                 {});
      cut->cache().wait();
    }
    EXPECT_FALSE(cut->cache().errors().empty());
    EXPECT_NE(cut->cache().errors().front().text().find("a.cuesta"), std::string::npos);
    const auto report = cut->settle(ErrorScale::uniform(cut->directory().grid), -1, {});
    EXPECT_TRUE(report.settled);
    EXPECT_LT(report.triangles, cut->directory().triangles);
  }
}

}  // namespace
}  // namespace cuesta::test
