#include "runtime/cost_model.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

namespace cuesta {
namespace {

constexpr std::size_t terms = CostModel::terms;
using Costs = CostModel::Costs;
using Matrix = std::array<Costs, terms>;

constexpr double forgetting = 0.98;
constexpr double tie_to_calibration = 1e-3;  // of a term's own information
constexpr double robust_deviations = 3, deviation_of_median = 1.4826;
constexpr double spread_step = 0.05, least_spread = 0.01;
/// Times drift with what is seen, so that the largest of few tells more than the second of many: over nine
/// recorded walks, 0.3 % of the frames are above a quarter more than the largest of 48, at 62 % load; above
/// the second largest of 256 are 0.8 %, at 65 %.
constexpr std::size_t remembered = 48;
/// OSMesa on one core, roughly.
constexpr Costs first_guess{1, 2e-3, 2e-4, 2e-6, 7e-6, 5e-5};

Costs terms_of(const FrameWork& work) {
  return {1, work.objects, work.triangles, work.fragments, work.pixels, work.changed_triangles};
}

double dot(const Costs& a, const Costs& b) {
  double sum = 0;
  for (std::size_t i = 0; i < terms; ++i) sum += a[i] * b[i];
  return sum;
}

/// Solves a x = b over the terms in `used`, the others zero, by Cholesky's factors.   @return none where a is
/// singular
std::optional<Costs> solve(const Matrix& a, const Costs& b, unsigned used) {
  std::array<std::size_t, terms> index{};
  std::size_t n = 0;
  for (std::size_t i = 0; i < terms; ++i)
    if (used >> i & 1) index[n++] = i;
  Matrix l{};
  Costs y{}, x{};
  for (std::size_t i = 0; i < n; ++i) {
    for (std::size_t j = 0; j <= i; ++j) {
      double v = a[index[i]][index[j]];
      for (std::size_t k = 0; k < j; ++k) v -= l[i][k] * l[j][k];
      if (i == j && !(v > 0)) return std::nullopt;
      l[i][j] = i == j ? std::sqrt(v) : v / l[j][j];
    }
    y[i] = b[index[i]];
    for (std::size_t k = 0; k < i; ++k) y[i] -= l[i][k] * y[k];
    y[i] /= l[i][i];
  }
  for (std::size_t i = n; i-- > 0;) {
    double v = y[i];
    for (std::size_t k = i + 1; k < n; ++k) v -= l[k][i] * x[index[k]];
    x[index[i]] = v / l[i][i];
  }
  return x;
}

/// The x ≥ 0 of least ½ xᵀax - bᵀx, by trying which terms are zero: 64 ways.
std::optional<Costs> solve_non_negative(const Matrix& a, const Costs& b) {
  std::optional<Costs> best;
  double least = std::numeric_limits<double>::infinity();
  for (unsigned used = 0; used < 1u << terms; ++used) {
    const auto x = solve(a, b, used);
    if (!x || *std::min_element(x->begin(), x->end()) < 0) continue;
    const double value = -dot(b, *x) / 2;  // where the gradient over the used terms is zero
    if (value < least) least = value, best = x;
  }
  return best;
}

bool usable(const Costs& x, double ms) {
  return std::isfinite(ms) && ms > 0 &&
         std::all_of(x.begin(), x.end(), [](double v) { return std::isfinite(v) && v >= 0; });
}

}  // namespace

CostModel::CostModel(std::span<const MeasuredFrame> measured)
    : calibrated_(first_guess), costs_(first_guess) {
  ratios_.reserve(remembered), ordered_.reserve(remembered);
  for (int pass = 0; pass < 3; ++pass) {  // The second and third know which frames are outliers.
    information_ = {}, target_ = {};
    for (const auto& [work, ms, guess] : measured) {
      const Costs x = terms_of(work);
      if (!usable(x, ms)) continue;
      const double deviation = pass == 0 ? 0 : std::abs(ms / dot(costs_, x) - 1);
      weigh_in(x, ms, std::min(1.0, robust_deviations * spread_ / std::max(deviation, 1e-12)));
    }
    fit();
  }
  calibrated_ = costs_;
  for (const auto& [work, ms, guess] : measured)
    if (usable(terms_of(work), ms)) remember(ms / std::max(predict_ms(guess), 1e-6));
}

double CostModel::predict_ms(const FrameWork& work) const {
  return dot(costs_, terms_of(work));
}

void CostModel::weigh_in(const Costs& x, double ms, double weight) {
  const double relative = weight / (ms * ms);
  for (std::size_t i = 0; i < terms; ++i) {
    target_[i] += relative * x[i] * ms;
    for (std::size_t j = 0; j < terms; ++j) information_[i][j] += relative * x[i] * x[j];
  }
}

void CostModel::fit() {
  Matrix a = information_;
  Costs b = target_;
  for (std::size_t i = 0; i < terms; ++i) {
    const double tie = tie_to_calibration * a[i][i] + std::numeric_limits<double>::min();
    a[i][i] += tie, b[i] += tie * calibrated_[i];
  }
  if (const auto x = solve_non_negative(a, b); x && *std::max_element(x->begin(), x->end()) > 0) costs_ = *x;
}

void CostModel::observe(const FrameWork& work, double ms, const FrameWork& guess) {
  const Costs x = terms_of(work);
  if (!usable(x, ms)) return;
  const double predicted = std::max(dot(costs_, x), 1e-6), deviation = std::abs(ms / predicted - 1);
  remember(ms / std::max(predict_ms(guess), 1e-6));
  spread_ = std::max(least_spread, spread_ * (1 + (deviation > spread_ ? spread_step : -spread_step)));
  for (std::size_t i = 0; i < terms; ++i) {
    target_[i] *= forgetting;
    for (double& v : information_[i]) v *= forgetting;
  }
  weigh_in(x, ms,
           std::min(1.0, robust_deviations * deviation_of_median * spread_ / std::max(deviation, 1e-12)));
  fit();
}

void CostModel::remember(double ratio) {
  if (ratios_.size() < remembered)
    ratios_.push_back(ratio);
  else
    ratios_[next_ratio_] = ratio, next_ratio_ = (next_ratio_ + 1) % remembered;
}

double CostModel::ratio(double quantile) const {
  constexpr double beyond_known = 1.25;
  const double rank = std::ceil(quantile * double(ratios_.size() + 1));
  double ratio = beyond_known;
  if (!ratios_.empty()) {
    ordered_ = ratios_;
    const bool known = rank <= double(ratios_.size());
    const auto at =
        ordered_.begin() + (known ? std::max(static_cast<std::ptrdiff_t>(rank) - 1, std::ptrdiff_t{0})
                                  : std::ssize(ordered_) - 1);
    std::nth_element(ordered_.begin(), at, ordered_.end());
    ratio = known ? *at : *at * beyond_known;
  }
  return std::clamp(ratio, 1.0, most_ratio);
}

}  // namespace cuesta
