#include "runtime/resolution_policy.h"

#include <algorithm>
#include <numeric>
#include <vector>

#include "ooc/check.h"

namespace cuesta {
namespace {

class PredictivePolicy final : public ResolutionPolicy {
 public:
  PredictivePolicy(const CostModel& costs, const PredictiveOptions& options)
      : costs_(costs), options_(options) {}

  ResolutionOutcome choose(const VisibleObjects& objects, const FrameTask& task, std::span<float> r,
                           const std::function<bool()>& out_of_time) override {
    interest_.resize(objects.size()), cost_.resize(objects.size());
    const auto triangle_ms = static_cast<float>(costs_.triangle_ms());
    for (std::size_t i = 0; i < objects.size(); ++i) {
      interest_[i] = objects.coverage[i] * objects.focus[i] * objects.weight[i];
      cost_[i] = triangle_ms * objects.triangles[i];
    }
    const double budget = task.deadline_ms / costs_.ratio(options_.quantile) - costs_.predict_ms(task.fixed);
    const auto problem = ResolutionProblem{interest_, cost_, objects.r_min, budget, options_.alpha};
    const ResolutionOutcome outcome = choose_resolutions(problem, scratch_, r, out_of_time).outcome;
    if (outcome == ResolutionOutcome::infeasible) leave_out_least(objects, budget, r);
    return outcome;
  }
  void measured(double, double) override {}

 private:
  /// Keeps the objects of most interest as far as their coarsest, the calls that draw them and what they fill
  /// fit.
  /// @param budget  after the costs of all objects   @cost O(objects): each step halves those that are
  /// undecided
  void leave_out_least(const VisibleObjects& objects, double budget, std::span<float> r) {
    order_.resize(r.size());
    std::iota(order_.begin(), order_.end(), 0u);
    const auto drawing_ms = [&](std::size_t i) {
      return costs_.object_ms() +
             (objects.fragments.empty() ? 0 : costs_.fragment_ms() * double(objects.fragments[i]));
    };
    double left = budget;
    for (std::size_t i = 0; i < r.size(); ++i) left += drawing_ms(i);
    auto from = order_.begin(), to = order_.end();
    while (from < to) {
      const auto middle = from + (to - from) / 2;
      std::nth_element(from, middle, to, [&](std::uint32_t a, std::uint32_t b) {
        return interest_[a] != interest_[b] ? interest_[a] > interest_[b] : a < b;
      });
      double cost = 0;
      for (auto i = from; i <= middle; ++i)
        cost += drawing_ms(*i) + double(cost_[*i]) * double(objects.r_min[*i]);
      if (cost > left) {
        to = middle;
      } else {
        left -= cost;
        from = middle + 1;
      }
    }
    for (; from < order_.end(); ++from) r[*from] = 0;
  }

  const CostModel& costs_;
  PredictiveOptions options_;
  std::vector<float> interest_, cost_;
  std::vector<std::uint32_t> order_;
  ResolutionScratch scratch_;
};

/// The coverage, mapped linearly to what each object has, up to full resolution at `full_coverage`.
void follow_coverage(const VisibleObjects& objects, double full_coverage, std::span<float> r) {
  const auto scale = static_cast<float>(1 / full_coverage);
  for (std::size_t i = 0; i < objects.size(); ++i)
    r[i] = objects.r_min[i] + (1 - objects.r_min[i]) * std::min(1.0f, objects.coverage[i] * scale);
}

/// Also the static heuristic: with a step of 0.
class StressPolicy final : public ResolutionPolicy {
 public:
  explicit StressPolicy(const StressOptions& options) : options_(options) {}

  ResolutionOutcome choose(const VisibleObjects& objects, const FrameTask&, std::span<float> r,
                           const std::function<bool()>&) override {
    follow_coverage(objects, options_.full_coverage * stress_, r);
    return ResolutionOutcome::heuristic;
  }
  void measured(double ms, double deadline_ms) override {
    const double load = ms / deadline_ms;
    stress_ *= load < options_.load_min   ? 1 - options_.alpha
               : load > options_.load_max ? 1 + options_.alpha
                                          : 1;
    stress_ = std::clamp(stress_, least_stress, most_stress);
  }

 private:
  static constexpr double least_stress = 1e-6, most_stress = 1e6;
  StressOptions options_;
  double stress_ = 1;
};

}  // namespace

float focus_at(double from_centre) {
  const double d = std::clamp(from_centre, 0.0, 1.0);
  return static_cast<float>(1 - 0.75 * d * d);
}

std::unique_ptr<ResolutionPolicy> predictive_policy(const CostModel& costs,
                                                    const PredictiveOptions& options) {
  return std::make_unique<PredictivePolicy>(costs, options);
}

std::unique_ptr<ResolutionPolicy> stress_policy(const StressOptions& options) {
  CUESTA_CHECK(options.alpha >= 0 && options.alpha < 1 && options.full_coverage > 0, options.alpha,
               options.full_coverage);
  return std::make_unique<StressPolicy>(options);
}

std::unique_ptr<ResolutionPolicy> fixed_policy(double full_coverage) {
  StressOptions options;
  options.alpha = 0, options.full_coverage = full_coverage;
  return stress_policy(options);
}

}  // namespace cuesta
