#include "runtime/resolution_optimizer.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "hierarchy/vector_clones.h"
#include "ooc/check.h"
#include "runtime/power.h"

namespace cuesta {
namespace {

using Open = ResolutionScratch::Open;

constexpr std::size_t lanes = 8;
constexpr std::size_t block = std::size_t{1} << 16;  // objects between looks at the clock
constexpr std::size_t sample_size = 8192;
/// Breakpoints of a sample to either side of its answer that bound the whole's: six deviations of their
/// number where all cost alike. Half as many miss where few objects have most of the cost, and a miss costs
/// more than is gained.
constexpr std::ptrdiff_t sample_margin = 400;
/// Part of the bracket that an interpolation is trusted to hit.
constexpr double interpolated_part = 1.0 / 16;
constexpr double infinity = std::numeric_limits<double>::infinity();
/// Breakpoints this near an end of the bracket, relative to it, count as outside: a round always decides its
/// pivots.
constexpr double tolerance = 1e-12;

/// Arrays of objects: all of a problem, or those that are open.
struct Objects {
  const float* cost;
  const float* r_min;
  const float* scale;
  std::size_t count;
};

Objects view(const Open& open, std::size_t count) {
  return {open.cost.data(), open.r_min.data(), open.scale.data(), count};
}

/// Sums in a fixed order that vector instructions can follow.
struct LaneSum {
  std::array<double, lanes> lane{};
  double total() const {
    double sum = 0;
    for (const double v : lane) sum += v;
    return sum;
  }
};

/// Σ term(i) over [0, n): eight sums side by side.
template <std::size_t N, class Terms>
[[gnu::always_inline]] inline std::array<double, N> sums(std::size_t n, const Terms& terms) {
  std::array<LaneSum, N> sum{};
  std::size_t i = 0;
  for (; i + lanes <= n; i += lanes)
    for (std::size_t l = 0; l < lanes; ++l) {
      const std::array<double, N> term = terms(i + l);
      for (std::size_t k = 0; k < N; ++k) sum[k].lane[l] += term[k];
    }
  for (std::size_t l = 0; i < n; ++i, ++l) {
    const std::array<double, N> term = terms(i);
    for (std::size_t k = 0; k < N; ++k) sum[k].lane[l] += term[k];
  }
  std::array<double, N> result;
  for (std::size_t k = 0; k < N; ++k) result[k] = sum[k].total();
  return result;
}

[[gnu::always_inline]] inline double resolution(const Objects& o, std::size_t i, double mu) {
  return std::min(std::max(mu * double(o.scale[i]), double(o.r_min[i])), 1.0);
}

/// Costs at r_min, and at 1.
CUESTA_VECTOR_CLONES
std::array<double, 2> cost_limits(const float* cost, const float* r_min, std::size_t n) {
  return sums<2>(n, [=](std::size_t i) {
    return std::array<double, 2>{double(cost[i]) * double(r_min[i]), double(cost[i])};
  });
}

/// Costs of the objects at two values of μ.
CUESTA_VECTOR_CLONES
std::array<double, 2> costs_at(const Objects o, double lo, double hi) {
  return sums<2>(o.count, [=](std::size_t i) {
    return std::array<double, 2>{double(o.cost[i]) * resolution(o, i, lo),
                                 double(o.cost[i]) * resolution(o, i, hi)};
  });
}

CUESTA_VECTOR_CLONES
void scales(const float* interest, const float* cost, std::size_t n, double exponent, float* scale) {
  for (std::size_t i = 0; i < n; ++i)
    scale[i] = float(vector_power(double(interest[i]) / double(cost[i]), exponent));
}

/// r = (1 - share) · r(lo) + share · r(hi), a little less: what rounding to float adds stays below.
CUESTA_VECTOR_CLONES
void write_resolutions(const Objects o, double lo, double hi, double share, float* r) {
  constexpr double less = 1 - 0x1p-23;
  for (std::size_t i = 0; i < o.count; ++i) {
    const double a = resolution(o, i, lo), b = resolution(o, i, hi);
    r[i] = std::max(float((a + share * (b - a)) * less), o.r_min[i]);
  }
}

/// The costs of decided objects at μ: fixed + slope · μ.
struct Piece {
  double fixed = 0, slope = 0;
};

/// Objects looked at together, in the first cache.
constexpr std::size_t part_size = 512;
struct Decided {
  std::array<double, part_size> fixed, slope;
  std::array<double, part_size> open;  // 1 where a breakpoint is within, else 0
};

/// What objects are for all μ within (lo, hi). Truths are 1 and 0: compilers make branches of others.
CUESTA_VECTOR_CLONES
void classify(const Objects o, double lo, double hi, Decided& to) {
  for (std::size_t i = 0; i < o.count; ++i) {
    const double scale = double(o.scale[i]), least = double(o.r_min[i]), cost = double(o.cost[i]);
    const double low = scale * lo, high = scale * hi;
    const double at_least = high <= least ? 1.0 : 0.0, at_most = low >= 1.0 ? 1.0 : 0.0;
    const double limited = std::max(at_least, at_most);
    const double free = (low >= least ? 1.0 : 0.0) * (high <= 1.0 ? 1.0 : 0.0) * (1 - limited);
    to.fixed[i] = cost * std::max(at_most, at_least * least);
    to.slope[i] = free * cost * scale;
    to.open[i] = 1 - limited - free;
  }
}

CUESTA_VECTOR_CLONES
Piece sum_of(const Decided& d, std::size_t n) {
  const auto sum = sums<2>(n, [&](std::size_t i) { return std::array<double, 2>{d.fixed[i], d.slope[i]}; });
  return {sum[0], sum[1]};
}

/// Keeps the objects marked open.   @return how many
std::size_t keep_open(const Objects& o, const Decided& decided, std::size_t kept, Open& to) {
  std::array<std::uint32_t, part_size> which;
  std::size_t count = 0;
  for (std::size_t i = 0; i < o.count; ++i) {
    which[count] = static_cast<std::uint32_t>(i);
    count += decided.open[i] > 0 ? 1 : 0;
  }
  if (to.cost.size() < kept + count) to.resize(std::max(kept + count, 2 * to.cost.size()));
  for (std::size_t k = 0; k < count; ++k, ++kept) {
    const std::size_t i = which[k];
    to.cost[kept] = o.cost[i], to.r_min[kept] = o.r_min[i], to.scale[kept] = o.scale[i];
  }
  return kept;
}

/// Values of μ between which the answer's lies, and the costs of all objects there.
struct Bracket {
  double lo = 0, hi = infinity;
  double cost_lo, cost_hi;
};

/// The search for the piece that holds the budget.
class Search {
 public:
  /// @param memory  two, for what is open before and after a round
  Search(Objects objects, double budget, Bracket bracket, Open* memory, std::vector<double>& breakpoints)
      : open_(objects), budget_(budget), bracket_(bracket), memory_(memory), breakpoints_(breakpoints) {}

  std::size_t open() const { return open_.count; }
  const Bracket& bracket() const { return bracket_; }
  /// Where the budget lies between the costs at the ends.
  double share() const {
    const double all = bracket_.cost_hi - bracket_.cost_lo;
    return all > 0 ? std::clamp((budget_ - bracket_.cost_lo) / all, 0.0, 1.0) : 0;
  }
  /// When nothing is open: on the one piece that is left.
  double mu() const {
    return piece_.slope > 0 ? std::clamp((budget_ - piece_.fixed) / piece_.slope, bracket_.lo, bracket_.hi)
                            : bracket_.lo;
  }

  /// Takes the upper or lower half of the breakpoints out.
  void median_round();
  /// Takes out what is not near where a straight line between the ends of the bracket meets the budget.
  void interpolation_round();
  /// Takes out what is not near the answer of a sample.
  void sample_round(ResolutionScratch& scratch);

 private:
  struct Trial {
    Piece piece;
    Objects open;
    double cost_lo, cost_hi;
  };
  Trial decide_outside(double lo, double hi);
  void narrow(double lo, double hi);
  void find_breakpoints(const Objects& objects);

  Objects open_;
  double budget_;
  Bracket bracket_;
  Piece piece_;
  Open* memory_;
  std::size_t free_memory_ = 0;
  std::vector<double>& breakpoints_;
};

Search::Trial Search::decide_outside(double lo, double hi) {
  Decided decided;
  Open& to = memory_[free_memory_];
  Trial trial{piece_, {}, bracket_.cost_lo, bracket_.cost_hi};
  std::size_t kept = 0;
  for (std::size_t begin = 0; begin < open_.count; begin += part_size) {
    const Objects part{open_.cost + begin, open_.r_min + begin, open_.scale + begin,
                       std::min(part_size, open_.count - begin)};
    classify(part, lo * (1 + tolerance), hi * (1 - tolerance), decided);
    const Piece sum = sum_of(decided, part.count);
    trial.piece.fixed += sum.fixed, trial.piece.slope += sum.slope;
    kept = keep_open(part, decided, kept, to);
  }
  trial.open = view(to, kept);
  const auto cost = costs_at(trial.open, lo, hi);
  if (lo > bracket_.lo) trial.cost_lo = trial.piece.fixed + trial.piece.slope * lo + cost[0];
  if (hi < bracket_.hi) trial.cost_hi = trial.piece.fixed + trial.piece.slope * hi + cost[1];
  return trial;
}

/// The new bracket is (lo, hi), within the old one, if the budget lies there; else what is beside it on that
/// side.
void Search::narrow(double lo, double hi) {
  Trial trial = decide_outside(lo, hi);
  const bool below = trial.cost_lo > budget_, above = trial.cost_hi < budget_;
  if (below) bracket_.hi = lo, bracket_.cost_hi = trial.cost_lo;
  if (above) bracket_.lo = hi, bracket_.cost_lo = trial.cost_hi;
  if (below || above)
    trial = decide_outside(bracket_.lo, bracket_.hi);
  else
    bracket_ = {lo, hi, trial.cost_lo, trial.cost_hi};
  piece_ = trial.piece, open_ = trial.open, free_memory_ ^= 1;
}

void Search::find_breakpoints(const Objects& objects) {
  const double above = bracket_.lo * (1 + tolerance), below = bracket_.hi * (1 - tolerance);
  breakpoints_.clear();
  for (std::size_t i = 0; i < objects.count; ++i)
    for (const double r : {double(objects.r_min[i]), 1.0})
      if (const double scale = double(objects.scale[i]); r > scale * above && r < scale * below)
        breakpoints_.push_back(r / scale);
}

void Search::median_round() {
  find_breakpoints(open_);
  const auto middle = breakpoints_.begin() + static_cast<std::ptrdiff_t>(breakpoints_.size() / 2);
  std::nth_element(breakpoints_.begin(), middle, breakpoints_.end());
  narrow(bracket_.lo, *middle);
}

void Search::interpolation_round() {
  const auto [lo, hi, cost_lo, cost_hi] = bracket_;
  const double middle = lo + share() * (hi - lo), half = (hi - lo) * interpolated_part / 2;
  narrow(std::max(lo, middle - half), std::min(hi, middle + half));
}

/// Rounds until nothing is open or time ends. Interpolation decides nearly all at once where breakpoints are
/// many and nearly nothing where they are oddly spaced; then a median decides half.   @return how many
std::uint32_t run(Search& search, const std::function<bool()>& out_of_time) {
  std::uint32_t rounds = 0;
  bool poor = false;
  for (; search.open() > 0 && !(out_of_time && out_of_time()); ++rounds) {
    const std::size_t before = search.open();
    if (poor || search.bracket().hi == infinity)
      search.median_round();
    else
      search.interpolation_round();
    poor = !poor && search.open() > before / 2;
  }
  return rounds;
}

/// Every so manieth of the objects.
Objects take_sample(const Objects& from, Open& to) {
  to.resize(sample_size);
  const double stride = double(from.count) / double(sample_size);
  for (std::size_t k = 0; k < sample_size; ++k) {
    const auto i = std::min(from.count - 1, static_cast<std::size_t>((double(k) + 0.5) * stride));
    to.cost[k] = from.cost[i], to.r_min[k] = from.r_min[i], to.scale[k] = from.scale[i];
  }
  return view(to, sample_size);
}

/// μ of the objects when their costs fill the same share of what is between the bracket's ends.
double sample_answer(const Objects& sample, Bracket bracket, double share, ResolutionScratch& scratch) {
  const auto [cost_lo, cost_hi] = costs_at(sample, bracket.lo, bracket.hi);
  bracket.cost_lo = cost_lo, bracket.cost_hi = cost_hi;
  Search search(sample, cost_lo + share * (cost_hi - cost_lo), bracket, scratch.sample_open,
                scratch.breakpoints);
  run(search, {});
  return search.mu();
}

void Search::sample_round(ResolutionScratch& scratch) {
  const Objects sample = take_sample(open_, scratch.sample);
  const double mu = sample_answer(sample, bracket_, share(), scratch);
  find_breakpoints(sample);
  std::vector<double>& b = breakpoints_;
  const auto below = std::count_if(b.begin(), b.end(), [=](double v) { return v < mu; });
  const auto lower = below - sample_margin, upper = below + sample_margin;
  double lo = bracket_.lo, hi = bracket_.hi;
  if (lower > 0) {
    std::nth_element(b.begin(), b.begin() + lower, b.end());
    lo = b[static_cast<std::size_t>(lower)];
  }
  if (upper < std::ssize(b)) {
    std::nth_element(b.begin(), b.begin() + upper, b.end());
    hi = b[static_cast<std::size_t>(upper)];
  }
  narrow(lo, hi);
}

/// @return false if time ended first
bool find_scales(const ResolutionProblem& p, std::vector<float>& scale,
                 const std::function<bool()>& out_of_time) {
  const std::size_t n = p.cost_ms.size();
  scale.resize(n);
  for (std::size_t begin = 0; begin < n; begin += block) {
    if (out_of_time && out_of_time()) return false;
    scales(p.interest.data() + begin, p.cost_ms.data() + begin, std::min(block, n - begin), 1 / (p.alpha + 1),
           scale.data() + begin);
  }
  return true;
}

/// r_min at share 0, full resolution at 1.
void write_between_limits(std::span<const float> r_min, double share, std::span<float> r) {
  constexpr double less = 1 - 0x1p-23;
  for (std::size_t i = 0; i < r.size(); ++i)
    r[i] = std::max(float((double(r_min[i]) + share * (1 - double(r_min[i]))) * less), r_min[i]);
}

}  // namespace

ResolutionAnswer choose_resolutions(const ResolutionProblem& p, ResolutionScratch& scratch,
                                    std::span<float> r, const std::function<bool()>& out_of_time) {
  const std::size_t n = p.cost_ms.size();
  CUESTA_CHECK(p.interest.size() == n && p.r_min.size() == n && r.size() == n, p.interest.size(), n,
               r.size());
  CUESTA_CHECK(p.alpha >= 0.05 && p.alpha <= 8, p.alpha);
  const auto [least, most] = cost_limits(p.cost_ms.data(), p.r_min.data(), n);
  if (most <= p.budget_ms) {
    std::fill(r.begin(), r.end(), 1.0f);
    return {ResolutionOutcome::full, most, 0, 0};
  }
  if (!(least <= p.budget_ms)) {
    std::copy(p.r_min.begin(), p.r_min.end(), r.begin());
    return {ResolutionOutcome::infeasible, least, 0, 0};
  }
  const double share = (p.budget_ms - least) / (most - least);
  if (!find_scales(p, scratch.scale, out_of_time)) {
    write_between_limits(p.r_min, share, r);
    return {ResolutionOutcome::early, p.budget_ms, 0, 0};
  }
  const Objects all{p.cost_ms.data(), p.r_min.data(), scratch.scale.data(), n};
  Search search(all, p.budget_ms, {0, infinity, least, most}, scratch.open, scratch.breakpoints);
  std::uint32_t rounds = 0;
  for (; rounds < 2 && search.open() > std::max(n / 4, 4 * sample_size) && !(out_of_time && out_of_time());
       ++rounds)
    search.sample_round(scratch);
  rounds += run(search, out_of_time);
  if (search.open() > 0) {
    write_resolutions(all, search.bracket().lo, search.bracket().hi, search.share(), r.data());
    return {ResolutionOutcome::early, p.budget_ms, 0, rounds};
  }
  const double mu = search.mu();
  write_resolutions(all, mu, mu, 0, r.data());
  return {ResolutionOutcome::optimal, p.budget_ms, p.alpha / std::pow(mu, p.alpha + 1), rounds};
}

}  // namespace cuesta
