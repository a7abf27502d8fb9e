#pragma once
/// The resolutions of many objects that give the best picture within a frame's time.
/// Source: Gobbetti, Scateni, Agus, "Exploring Virtual Prototypes Using Time-Critical Multiresolution
/// Rendering", §3.1: minimise Σ interest_i · r_i^-α  subject to  Σ cost_i · r_i ≤ budget,  r_min_i ≤ r_i ≤ 1.
/// Deviation: their active-set method iterates and may have to stop early; this is exact in linear time. At
/// the optimum r_i = clamp(μ · (interest_i / cost_i)^(1/(α+1)), r_min_i, 1) with one μ for all objects, and
/// the cost as a function of μ is piecewise linear and rising: two breakpoints per object. What is sought is
/// the piece that holds the budget. Each round takes two order statistics of the breakpoints of a sample
/// about the sample's own answer (Floyd and Rivest select like this), and decides all objects whose
/// breakpoints lie outside. A round that decides less than half is followed by one that takes the median of
/// all, so a bad sample costs time but not linearity. Nothing is sorted.

#include <cstdint>
#include <functional>
#include <span>
#include <vector>

namespace cuesta {

/// One element per object in each span. The lengths are equal.
struct ResolutionProblem {
  std::span<const float> interest;  ///< ≥ 0, finite, any unit: how much its degradation counts
  std::span<const float> cost_ms;  ///< ≥ 0, finite: of r = 1 over that of r → 0; costs that do not depend on
                                   ///< r are to be taken off the budget by the caller
  std::span<const float> r_min;  ///< within [0, 1]
  double budget_ms = 0;
  double alpha = 1;  ///< within [0.05, 8]; degradation ~ r^-α: 1 where error halves when triangles double
};

enum class ResolutionOutcome : std::uint8_t {
  full,        ///< all objects fit at r = 1
  optimal,     ///< the budget binds, and nothing better fits it
  early,       ///< out of time: fits the budget, better than where it started, not the best
  infeasible,  ///< even r_min costs more than the budget: r_min everywhere
  heuristic,   ///< no budget was looked at: policies other than the predictive one
};

struct ResolutionAnswer {
  ResolutionOutcome outcome = ResolutionOutcome::full;
  double cost_ms = 0;  ///< Σ cost_i · r_i; above the budget only where infeasible
  double lambda =
      0;  ///< gain of one more millisecond, interest per ms (the Lagrange multiplier); 0 unless optimal
  std::uint32_t rounds = 0;
};

inline constexpr double resolution_error = 5e-7;

/// Memory of the solver: 4 bytes per object, and 24 per object that a round leaves open (most often one in
/// ten). Kept between calls, it is not allocated again.
class ResolutionScratch {
 public:
  struct Open {
    std::vector<float> cost, r_min, scale;
    void resize(std::size_t n) { cost.resize(n), r_min.resize(n), scale.resize(n); }
  };
  std::vector<float> scale;         ///< per object, (interest / cost)^(1/(α+1))
  Open open[2];                     ///< not decided yet, before and after a round
  Open sample, sample_open[2];      ///< of what is open
  std::vector<double> breakpoints;  ///< of a sample, or of all that are open
};

/// @param r            one per object; written whole, whatever the outcome
/// @param out_of_time  asked between blocks of 2^16 objects and between rounds
/// @post r_min ≤ r ≤ 1; Σ cost_i · r_i ≤ budget unless infeasible (r is rounded towards less).
/// Within `resolution_error` of the exact answer, relative to each r.
/// @error never; spans of different lengths and an alpha out of range are the caller's bug.
/// @cost O(objects), expected and worst; one core, no locks; about 7 ns per object. No allocation after
/// warm-up.
ResolutionAnswer choose_resolutions(const ResolutionProblem& problem, ResolutionScratch& scratch,
                                    std::span<float> r, const std::function<bool()>& out_of_time = {});

}  // namespace cuesta
