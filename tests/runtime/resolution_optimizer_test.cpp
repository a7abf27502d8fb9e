#include "runtime/resolution_optimizer.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <random>
#include <string>

namespace cuesta::test {
namespace {

struct Instance {
  std::vector<float> interest, cost, r_min;
  double budget = 0, alpha = 1;

  std::size_t size() const { return cost.size(); }
  ResolutionProblem problem() const { return {interest, cost, r_min, budget, alpha}; }
  double cost_of(const std::vector<double>& r) const {
    double sum = 0;
    for (std::size_t i = 0; i < size(); ++i) sum += double(cost[i]) * r[i];
    return sum;
  }
  double least() const { return cost_of({r_min.begin(), r_min.end()}); }
  double most() const { return cost_of(std::vector<double>(size(), 1.0)); }
  double degradation(std::span<const float> r) const {
    double sum = 0;
    for (std::size_t i = 0; i < size(); ++i) sum += double(interest[i]) * std::pow(double(r[i]), -alpha);
    return sum;
  }
};

/// What a frame's objects may look like.
enum class Kind { alike, even, few_have_most, ties, extremes };

Instance make(Kind kind, std::size_t n, double share, double alpha, std::uint64_t seed) {
  std::mt19937_64 random(seed);
  std::uniform_real_distribution<float> even(0.01f, 1);
  std::lognormal_distribution<float> skewed(0, 3);
  std::uniform_int_distribution<int> step(1, 3), one_in_eight(0, 7);
  Instance in;
  in.alpha = alpha;
  for (std::size_t i = 0; i < n; ++i) {
    float w = 1, c = 1, least = 0.1f;
    if (kind == Kind::even) w = even(random), c = even(random), least = 0.5f * even(random);
    if (kind == Kind::few_have_most) w = skewed(random), c = skewed(random), least = 0.01f * even(random);
    if (kind == Kind::ties)
      w = float(step(random)), c = float(step(random)), least = 0.25f * float(step(random));
    if (kind == Kind::extremes) {
      w = one_in_eight(random) == 0 ? 0 : skewed(random);
      c = one_in_eight(random) == 0 ? 0 : 1e-6f * skewed(random);
      least = one_in_eight(random) == 0 ? 1 : one_in_eight(random) == 0 ? 0 : even(random);
    }
    in.interest.push_back(w), in.cost.push_back(c), in.r_min.push_back(least);
  }
  in.budget = in.least() + share * (in.most() - in.least());
  return in;
}

/// The dual solved by bisection: for a multiplier λ each object minimises w r^-α + λ c r on its own.
std::vector<double> resolutions_for(const Instance& in, double log_lambda) {
  std::vector<double> r(in.size());
  for (std::size_t i = 0; i < in.size(); ++i) {
    const double w = double(in.interest[i]), c = double(in.cost[i]), least = double(in.r_min[i]);
    r[i] = c == 0 ? 1
           : w == 0
               ? least
               : std::clamp(std::exp((std::log(in.alpha * w / c) - log_lambda) / (in.alpha + 1)), least, 1.0);
  }
  return r;
}

std::vector<double> reference(const Instance& in) {
  double lo = -500, hi = 500;  // of log λ; the cost falls with it
  for (int i = 0; i < 200 && hi - lo > 1e-15 * std::abs(hi); ++i) {
    const double middle = (lo + hi) / 2;
    (in.cost_of(resolutions_for(in, middle)) > in.budget ? lo : hi) = middle;
  }
  return resolutions_for(in, hi);
}

std::vector<float> solve(const Instance& in, ResolutionAnswer* answer = nullptr) {
  static ResolutionScratch scratch;
  std::vector<float> r(in.size());
  const ResolutionAnswer got = choose_resolutions(in.problem(), scratch, r);
  if (answer) *answer = got;
  return r;
}

double worst_difference(const Instance& in, const std::vector<float>& r, const std::vector<double>& exact) {
  double worst = 0;
  for (std::size_t i = 0; i < in.size(); ++i)
    if (in.cost[i] > 0) worst = std::max(worst, std::abs(double(r[i]) - exact[i]) / std::max(exact[i], 1e-9));
  return worst;
}

std::string describe(const Instance& in, std::uint64_t seed) {
  return "n " + std::to_string(in.size()) + " alpha " + std::to_string(in.alpha) + " budget " +
         std::to_string(in.budget) + " seed " + std::to_string(seed);
}

TEST(ChooseResolutions, EqualsAConvexSolver) {
  std::uint64_t seed = 100;
  for (const Kind kind : {Kind::alike, Kind::even, Kind::few_have_most, Kind::ties})
    for (const std::size_t n : {1, 2, 3, 10, 100, 3000})
      for (const double share : {1e-4, 0.1, 0.5, 0.9})
        for (const double alpha : {0.25, 1.0, 3.0}) {
          const Instance in = make(kind, n, share, alpha, ++seed);
          ResolutionAnswer answer;
          const auto r = solve(in, &answer);
          ASSERT_EQ(answer.outcome, ResolutionOutcome::optimal) << describe(in, seed);
          ASSERT_LT(worst_difference(in, r, reference(in)), 1e-6) << describe(in, seed);
        }
}

TEST(ChooseResolutions, EqualsAConvexSolverForManyObjects) {
  for (const Kind kind : {Kind::alike, Kind::even, Kind::few_have_most, Kind::ties})
    for (const double share : {0.001, 0.3, 0.99}) {
      const Instance in = make(kind, 200'000, share, 1, 5);
      ASSERT_LT(worst_difference(in, solve(in), reference(in)), 1e-6) << int(kind) << ' ' << share;
    }
}

/// Conditions of Karush, Kuhn and Tucker; with the budget met and all r within bounds they are sufficient
/// here.
void expect_kkt(const Instance& in, const std::vector<float>& r, double lambda, std::uint64_t seed) {
  for (std::size_t i = 0; i < in.size(); ++i) {
    if (in.interest[i] == 0 || in.cost[i] == 0) continue;
    const double gain = in.alpha * double(in.interest[i]) * std::pow(double(r[i]), -in.alpha - 1);
    const double price = lambda * double(in.cost[i]);
    const bool could_rise = r[i]<0.999999f, could_fall = r[i]> in.r_min[i];
    ASSERT_TRUE(!could_rise || gain < price * (1 + 1e-5)) << describe(in, seed) << " at " << i;
    ASSERT_TRUE(!could_fall || gain > price * (1 - 1e-5)) << describe(in, seed) << " at " << i;
  }
}

TEST(ChooseResolutions, MeetsKkt) {
  for (std::uint64_t seed = 1; seed <= 40; ++seed) {
    const Kind kind = static_cast<Kind>(seed % 5);
    const Instance in =
        make(kind, 1 + seed * seed * 13, 0.02 * double(seed), 0.2 * double(seed % 9 + 1), seed);
    ResolutionAnswer answer;
    const auto r = solve(in, &answer);
    if (answer.outcome != ResolutionOutcome::optimal) continue;
    expect_kkt(in, r, answer.lambda, seed);
    const double cost = in.cost_of({r.begin(), r.end()});
    ASSERT_LE(cost, in.budget) << describe(in, seed);
    ASSERT_GT(cost, in.budget * (1 - 1e-6)) << describe(in, seed);
  }
}

TEST(ChooseResolutions, StaysWithinBoundsAndBudget) {
  for (std::uint64_t seed = 1; seed <= 60; ++seed) {
    const Instance in = make(Kind::extremes, 1 + seed * 97, 0.0166 * double(seed), 1, seed);
    const auto r = solve(in);
    for (std::size_t i = 0; i < in.size(); ++i)
      ASSERT_TRUE(r[i] >= in.r_min[i] && r[i] <= 1) << describe(in, seed) << " at " << i << ": " << r[i];
    ASSERT_LE(in.cost_of({r.begin(), r.end()}), in.budget) << describe(in, seed);
  }
}

TEST(ChooseResolutions, WhatFitsIsFull) {
  Instance in = make(Kind::even, 50, 1.01, 1, 3);
  ResolutionAnswer answer;
  for (const float r : solve(in, &answer)) EXPECT_EQ(r, 1);
  EXPECT_EQ(answer.outcome, ResolutionOutcome::full);
  EXPECT_NEAR(answer.cost_ms, in.most(), 1e-9);
}

TEST(ChooseResolutions, WhatCannotFitIsAtItsLeastAndReported) {
  Instance in = make(Kind::even, 50, 0.5, 1, 3);
  for (const double budget : {in.least() * 0.99, 0.0, -5.0, std::nan("")}) {
    in.budget = budget;
    ResolutionAnswer answer;
    EXPECT_EQ(solve(in, &answer), in.r_min);
    EXPECT_EQ(answer.outcome, ResolutionOutcome::infeasible);
    EXPECT_GT(answer.cost_ms, 0);
  }
}

TEST(ChooseResolutions, NoObjectsAreFull) {
  ResolutionAnswer answer;
  EXPECT_TRUE(solve(Instance{}, &answer).empty());
  EXPECT_EQ(answer.outcome, ResolutionOutcome::full);
}

TEST(ChooseResolutions, WhatCostsNothingIsFullAndWhatInterestsNobodyIsAtItsLeast) {
  Instance in{{1, 0, 1}, {0, 1, 1}, {0.1f, 0.1f, 0.1f}, 0.6, 1};
  const auto r = solve(in);
  EXPECT_NEAR(r[0], 1, 1e-6);
  EXPECT_NEAR(r[1], 0.1, 1e-6);
  EXPECT_NEAR(r[2], 0.5, 1e-6);
}

TEST(ChooseResolutions, ByHand) {
  // α = 1: r ~ √(w/c), 3 : 2 : 1. At μ = 0.4 the first is at its limit: 1 + 0.8 + 4 · 0.4 = 3.4.
  const Instance in{{9, 4, 4}, {1, 1, 4}, {0.01f, 0.01f, 0.01f}, 3.4, 1};
  ResolutionAnswer answer;
  const auto r = solve(in, &answer);
  EXPECT_NEAR(r[0], 1, 1e-6);
  EXPECT_NEAR(r[1], 0.8, 1e-6);
  EXPECT_NEAR(r[2], 0.4, 1e-6);
  EXPECT_NEAR(answer.lambda, 1 / (0.4 * 0.4), 1e-5);
  EXPECT_EQ(answer.cost_ms, 3.4);
}

TEST(ChooseResolutions, EarlyStopFitsAndImproves) {
  const Instance in = make(Kind::few_have_most, 300'000, 0.2, 1, 9);
  ResolutionScratch scratch;
  std::vector<float> r(in.size());
  std::vector<double> found;
  for (int asked = 0;; ++asked) {
    int calls = 0;
    const auto answer = choose_resolutions(in.problem(), scratch, r, [&] { return calls++ >= asked; });
    ASSERT_LE(in.cost_of({r.begin(), r.end()}), in.budget) << asked;
    ASSERT_GT(in.cost_of({r.begin(), r.end()}), in.budget * 0.999) << asked;
    found.push_back(in.degradation(r));
    if (answer.outcome == ResolutionOutcome::optimal) break;
    ASSERT_EQ(answer.outcome, ResolutionOutcome::early);
  }
  ASSERT_GE(found.size(), 7u);
  EXPECT_LT(found.back(), found.front() * 0.5);
  for (std::size_t i = 1; i < found.size(); ++i) EXPECT_LE(found[i], found[i - 1] * (1 + 1e-6)) << i;
}

TEST(ChooseResolutions, DoesNotAllocateAgain) {
  const Instance in = make(Kind::few_have_most, 100'000, 0.3, 1, 4);
  ResolutionScratch s;
  std::vector<float> r(in.size());
  const auto memory = [&] {
    return std::array<const void*, 6>{
        s.scale.data(),       s.open[0].cost.data(),        s.open[1].cost.data(),
        s.sample.cost.data(), s.sample_open[0].cost.data(), s.breakpoints.data()};
  };
  choose_resolutions(in.problem(), s, r);
  const auto before = memory();
  choose_resolutions(in.problem(), s, r);
  EXPECT_EQ(memory(), before);
  EXPECT_LT(s.open[0].cost.capacity() + s.open[1].cost.capacity(), in.size()) << "most are decided at once";
}

TEST(ChooseResolutions, SameAnswerAgain) {
  const Instance in = make(Kind::few_have_most, 100'000, 0.4, 1.5, 2);
  ResolutionScratch used, fresh;
  std::vector<float> a(in.size()), b(in.size()), other(150'000);
  choose_resolutions(make(Kind::even, other.size(), 0.3, 1, 1).problem(), used, other);
  choose_resolutions(in.problem(), used, a);
  choose_resolutions(in.problem(), fresh, b);
  EXPECT_EQ(a, b);
}

}  // namespace
}  // namespace cuesta::test
