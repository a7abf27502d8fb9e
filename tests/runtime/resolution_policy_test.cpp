#include "runtime/resolution_policy.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

namespace cuesta::test {
namespace {

constexpr double deadline_ms = 33;
constexpr CostModel::Costs machine{2, 1e-2, 1e-4, 0, 0, 0};

struct Objects {
  std::vector<float> coverage, focus, weight, triangles, r_min;

  explicit Objects(std::size_t n) {
    std::mt19937_64 random(n);
    std::uniform_real_distribution<float> even(0, 1);
    for (std::size_t i = 0; i < n; ++i) {
      coverage.push_back(0.05f * even(random)), focus.push_back(1), weight.push_back(1);
      triangles.push_back(20'000 * even(random)), r_min.push_back(0.01f);
    }
  }
  VisibleObjects view() const { return {coverage, focus, weight, triangles, r_min}; }
  double drawn(std::span<const float> r) const {
    double sum = 0;
    for (std::size_t i = 0; i < r.size(); ++i) sum += double(r[i]) * double(triangles[i]);
    return sum;
  }
};

/// A machine with known costs, drawing what a policy chooses.
struct Drawn {
  std::vector<double> ms;
  std::vector<float> last;
};

Drawn draw(ResolutionPolicy& policy, CostModel& costs, const Objects& objects, int frames) {
  Drawn drawn;
  drawn.last.resize(objects.coverage.size());
  for (int i = 0; i < frames; ++i) {
    FrameWork work{double(objects.coverage.size()), 0, 0, 0, 0};
    policy.choose(objects.view(), {deadline_ms, work}, drawn.last, {});
    work.triangles = objects.drawn(drawn.last);
    const double ms = machine[0] + machine[1] * work.objects + machine[2] * work.triangles;
    costs.observe(work, ms);
    policy.measured(ms, deadline_ms);
    drawn.ms.push_back(ms);
  }
  return drawn;
}

CostModel calibrated() {
  std::vector<MeasuredFrame> measured;
  for (int i = 1; i <= 100; ++i) {
    const FrameWork w{double(i * 7 % 50), 3000.0 * i, 0, 0, 0};
    measured.push_back({w, machine[0] + machine[1] * w.objects + machine[2] * w.triangles});
  }
  return CostModel(measured);
}

TEST(ResolutionPolicy, PredictiveKeepsTheDeadlineWhenACrowdEnters) {
  CostModel costs = calibrated();
  const auto policy = predictive_policy(costs);
  for (const std::size_t n : {10, 900, 10, 900})
    for (const double ms : draw(*policy, costs, Objects(n), 20).ms) ASSERT_LE(ms, deadline_ms) << n;
  EXPECT_GT(draw(*policy, costs, Objects(900), 1).ms[0], 0.75 * deadline_ms);
}

TEST(ResolutionPolicy, StressIsLateWhenACrowdEntersAndRecovers) {
  CostModel costs = calibrated();
  const auto policy = stress_policy();
  draw(*policy, costs, Objects(10), 60);
  const auto ms = draw(*policy, costs, Objects(900), 60).ms;
  EXPECT_GT(ms.front(), 1.2 * deadline_ms);
  EXPECT_LE(ms.back(), deadline_ms);
  EXPECT_GE(ms.back(), 0.5 * deadline_ms);
}

/// load < 0.5: stress · 0.6; load > 1: stress · 1.4; between, nothing.
TEST(ResolutionPolicy, StressFollowsLoadOutsideOfItsBand) {
  Objects one(1);
  one.coverage = {0.25f}, one.r_min = {0};
  std::vector<float> r(1);
  const auto policy = stress_policy();
  const auto after = [&](double load) {
    policy->measured(load * deadline_ms, deadline_ms);
    EXPECT_EQ(policy->choose(one.view(), {deadline_ms, {}}, r, {}), ResolutionOutcome::heuristic);
    return r[0];
  };
  EXPECT_NEAR(after(0.7), 0.25, 1e-6);
  EXPECT_NEAR(after(0.4), 0.25 / 0.6, 1e-6);
  EXPECT_NEAR(after(0.99), 0.25 / 0.6, 1e-6);
  EXPECT_NEAR(after(1.01), 0.25 / 0.6 / 1.4, 1e-6);
  for (int i = 0; i < 20; ++i) after(0.1);
  EXPECT_EQ(after(0.7), 1);
}

TEST(ResolutionPolicy, FixedLooksAtCoverageOnly) {
  CostModel costs = calibrated();
  const auto policy = fixed_policy(0.05);
  const Objects crowd(900);
  const Drawn drawn = draw(*policy, costs, crowd, 5);
  EXPECT_GT(drawn.ms.back(), 2 * deadline_ms);
  EXPECT_EQ(drawn.ms.front(), drawn.ms.back());
  for (std::size_t i = 0; i < 900; ++i)
    ASSERT_NEAR(drawn.last[i], 0.01 + 0.99 * double(crowd.coverage[i]) / 0.05, 1e-5) << i;
}

TEST(ResolutionPolicy, PredictiveGivesMoreToWhatInterestsMore) {
  CostModel costs = calibrated();
  Objects four(4);
  four.coverage = {0.1f, 0.4f, 0.1f, 0.1f}, four.focus = {1, 1, 0.25f, 1}, four.weight = {1, 1, 1, 9};
  four.triangles.assign(4, 2e5f), four.r_min.assign(4, 0.001f);
  std::vector<float> r(4);
  EXPECT_EQ(predictive_policy(costs)->choose(four.view(), {deadline_ms, {4, 0, 0, 0, 0}}, r, {}),
            ResolutionOutcome::optimal);
  EXPECT_NEAR(r[1] / r[0], 2, 1e-4);
  EXPECT_NEAR(r[2] / r[0], 0.5, 1e-4);
  EXPECT_NEAR(r[3] / r[0], 3, 1e-4);
}

TEST(ResolutionPolicy, PredictiveLeavesOutTheLeastWhereNotAllFit) {
  CostModel costs = calibrated();
  const Objects crowd(50'000);  // 500 ms of objects alone
  const VisibleObjects view = crowd.view();
  std::vector<float> r(50'000);
  EXPECT_EQ(predictive_policy(costs)->choose(view, {deadline_ms, {50'000, 0, 0, 0, 0}}, r, {}),
            ResolutionOutcome::infeasible);
  float least_kept = 1, most_left_out = 0;
  FrameWork work;
  for (std::size_t i = 0; i < r.size(); ++i) {
    ASSERT_TRUE(r[i] == 0 || r[i] == crowd.r_min[i]);
    if (r[i] == 0) most_left_out = std::max(most_left_out, crowd.coverage[i]);
    if (r[i] > 0) least_kept = std::min(least_kept, crowd.coverage[i]);
    if (r[i] > 0) ++work.objects, work.triangles += double(r[i]) * double(crowd.triangles[i]);
  }
  EXPECT_GE(least_kept, most_left_out);
  const double aim = deadline_ms / costs.ratio(0.99);
  EXPECT_LE(costs.predict_ms(work), aim + 1e-6);
  EXPECT_GT(costs.predict_ms(work), aim - 0.1) << "as many as fit";
}

TEST(ResolutionPolicy, PredictiveDrawsNothingWhenEvenTheFrameIsTooDear) {
  CostModel costs = calibrated();
  const Objects few(10);
  std::vector<float> r(10);
  predictive_policy(costs)->choose(few.view(), {0.5, {10, 0, 0, 0, 0}}, r, {});
  EXPECT_EQ(r, std::vector<float>(10));
}

TEST(ResolutionPolicy, AShareIsABudgetOfTriangles) {
  EXPECT_EQ(triangle_budget(0.25f, 4e9), 1'000'000'000u);
  EXPECT_EQ(triangle_budget(1, 7), 7u);
  EXPECT_EQ(triangle_budget(0, 7), 0u);
}

TEST(FocusAt, IsOneInTheMiddleAndAQuarterInTheCorners) {
  EXPECT_EQ(focus_at(0), 1);
  EXPECT_EQ(focus_at(1), 0.25f);
  EXPECT_EQ(focus_at(7), 0.25f);
  EXPECT_GT(focus_at(0.3), focus_at(0.4));
}

}  // namespace
}  // namespace cuesta::test
