#include "runtime/cost_model.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>

namespace cuesta::test {
namespace {

constexpr CostModel::Costs machine{2, 3e-3, 1e-4, 2e-6, 7e-6, 2e-5};

double true_ms(const FrameWork& w, const CostModel::Costs& c = machine) {
  return c[0] + c[1] * w.objects + c[2] * w.triangles + c[3] * w.fragments + c[4] * w.pixels +
         c[5] * w.changed_triangles;
}

class Frames {
 public:
  explicit Frames(std::uint64_t seed) : random_(seed) {}
  FrameWork work() {
    std::uniform_real_distribution<double> share(0, 1);
    return {1000 * share(random_), 3e5 * share(random_), 5e6 * share(random_), 1e6 * share(random_),
            5e4 * share(random_)};
  }
  double noise(double sigma) { return std::exp(std::normal_distribution<double>(0, sigma)(random_)); }
  bool rarely() { return std::uniform_int_distribution<int>(0, 19)(random_) == 0; }
  std::vector<MeasuredFrame> measured(int n, double sigma) {
    std::vector<MeasuredFrame> frames;
    for (int i = 0; i < n; ++i) {
      const FrameWork w = work();
      frames.push_back({w, true_ms(w) * noise(sigma)});
    }
    return frames;
  }

 private:
  std::mt19937_64 random_;
};

double median(std::vector<double> v) {
  std::nth_element(v.begin(), v.begin() + std::ssize(v) / 2, v.end());
  return v[v.size() / 2];
}

double median_error(const CostModel& model, Frames& frames, const CostModel::Costs& costs = machine) {
  std::vector<double> errors;
  for (int i = 0; i < 500; ++i) {
    const FrameWork w = frames.work();
    errors.push_back(std::abs(model.predict_ms(w) / true_ms(w, costs) - 1));
  }
  return median(errors);
}

TEST(CostModel, CalibrationFindsTheCosts) {
  Frames frames(1);
  const CostModel model(frames.measured(40, 0));
  for (std::size_t i = 0; i < CostModel::terms; ++i) EXPECT_NEAR(model.costs()[i] / machine[i], 1, 0.05) << i;
  EXPECT_LT(median_error(model, frames), 0.005);
}

TEST(CostModel, NoCostIsEverNegative) {
  Frames frames(2);
  CostModel model;
  for (int i = 0; i < 300; ++i) {
    model.observe(frames.work(), 10 * frames.noise(1.5));
    ASSERT_GE(*std::min_element(model.costs().begin(), model.costs().end()), 0) << i;
    ASSERT_GT(model.predict_ms(frames.work()), 0) << i;
  }
}

TEST(CostModel, OutliersMoveItLittle) {
  Frames frames(3);
  CostModel model(frames.measured(40, 0.05));
  for (int i = 0; i < 500; ++i) {
    const FrameWork w = frames.work();
    model.observe(w, true_ms(w) * frames.noise(0.05) * (frames.rarely() ? 8 : 1));
  }
  EXPECT_LT(median_error(model, frames), 0.08);
}

TEST(CostModel, FollowsAMachineThatBecomesSlower) {
  Frames frames(4);
  CostModel model(frames.measured(40, 0.05));
  CostModel::Costs slow = machine;
  for (double& c : slow) c *= 1.8;
  EXPECT_GT(median_error(model, frames, slow), 0.3);
  for (int i = 0; i < 200; ++i) {
    const FrameWork w = frames.work();
    model.observe(w, true_ms(w, slow) * frames.noise(0.05));
  }
  EXPECT_LT(median_error(model, frames, slow), 0.06);
}

TEST(CostModel, WhatFramesDoNotTellApartStaysCalibrated) {
  Frames frames(5);
  CostModel model(frames.measured(40, 0));
  for (int i = 0; i < 500; ++i) {
    FrameWork w{400, 1e5, 2e6, 5e5, 1e4};  // a steady flight: always the same
    model.observe(w, true_ms(w) * frames.noise(0.03));
  }
  EXPECT_LT(median_error(model, frames), 0.05);
}

/// The deadline over the ratio is what a frame may be predicted to take.
TEST(CostModel, AQuantileHoldsTheDeadline) {
  Frames frames(6);
  CostModel model(frames.measured(60, 0.1));
  int late = 0, n = 5000;
  double used = 0;
  for (int i = 0; i < n; ++i) {
    FrameWork w = frames.work();
    const double aim = 33 / model.ratio(0.995);
    w.triangles = 0;
    w.triangles = (aim - model.predict_ms(w)) / model.triangle_ms();
    const double ms = true_ms(w) * frames.noise(0.1);
    late += ms > 33 ? 1 : 0;
    used += ms / 33 / n;
    model.observe(w, ms);
  }
  EXPECT_LE(late, n / 100);
  EXPECT_GT(used, 0.6);
}

TEST(CostModel, RatioIsOverWhatWasKnownBefore) {
  Frames frames(8);
  std::vector<MeasuredFrame> measured = frames.measured(40, 0);
  EXPECT_LT(CostModel(measured).ratio(0.9), 1.05);
  for (MeasuredFrame& m : measured) m.guess.fragments = m.guess.pixels = m.guess.triangles = 0;
  const CostModel model(measured);
  EXPECT_LT(median_error(model, frames), 0.005) << "costs are fitted to what was drawn";
  EXPECT_GT(model.ratio(0.9), 1.5);
}

TEST(CostModel, RatioIsAnOrderStatistic) {
  std::vector<MeasuredFrame> measured(99, {{0, 1e5, 0, 0, 0}, 10});
  CostModel model(measured);
  const double ms = model.predict_ms({0, 1e5, 0, 0, 0});
  for (int i = 0; i < 12; ++i) model.observe({0, 1e5, 0, 0, 0}, 1.5 * ms);
  EXPECT_NEAR(model.ratio(0.5), 1, 0.05);
  EXPECT_GT(model.ratio(0.95), 1.2);
  EXPECT_LE(model.ratio(0.9999), CostModel::most_ratio);
  EXPECT_GT(CostModel().ratio(0.5), 1) << "nothing is known";
}

TEST(CostModel, RatioForgetsAfter48Frames) {
  const FrameWork work{0, 1e5, 0, 0, 0};
  CostModel model(std::vector<MeasuredFrame>(48, {work, 10}));
  model.observe(work, 16);
  for (int i = 0; i < 47; ++i) model.observe(work, model.predict_ms(work));
  EXPECT_GT(model.ratio(0.99), 1.9);
  model.observe(work, model.predict_ms(work));
  EXPECT_NEAR(model.ratio(0.99), 1.25, 0.01);
}

TEST(CostModel, TimesThatAreNoneAreIgnored) {
  Frames frames(7);
  CostModel model(frames.measured(40, 0));
  const auto before = model.costs();
  for (const double ms : {0.0, -1.0, std::nan(""), std::numeric_limits<double>::infinity()})
    model.observe(frames.work(), ms);
  model.observe({std::nan(""), 0, 0, 0, 0}, 5);
  EXPECT_EQ(model.costs(), before);
}

}  // namespace
}  // namespace cuesta::test
