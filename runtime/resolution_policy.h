#pragma once
/// Three ways to choose the resolutions of a frame's objects, behind one interface.
///   predictive  the best picture that the deadline allows, by what the frame is going to take (TIME §3.1)
///   stress      what the objects cover on the screen, over a factor that follows what past frames took:
///               Bouvier, Gobbetti, "TOM: Totally Ordered Mesh", §4.4
///   fixed       what they cover on the screen and nothing else: the static heuristics of TIME §2.3
/// The latter two are there to be compared with: the second learns of a crowded view only after it was late,
/// the third never.

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string_view>

#include "runtime/cost_model.h"
#include "runtime/resolution_optimizer.h"

namespace cuesta {

/// A frame's potentially visible objects: one element per object in each span, lengths equal (or 0:
/// fragments).
struct VisibleObjects {
  std::span<const float> coverage;   ///< share of the picture that the object's bounds cover, within [0, 1]
  std::span<const float> focus;      ///< within [0, 1]: 1 where the user looks, see focus_at()
  std::span<const float> weight;     ///< the user's, ≥ 0; 1 for most
  std::span<const float> triangles;  ///< at r = 1
  std::span<const float> r_min;      ///< within [0, 1], of what is always drawn
  std::span<const float> fragments =
      {};  ///< that it is likely to have, part of FrameTask::fixed; empty: not known

  std::size_t size() const { return coverage.size(); }
};

/// Objects away from the centre of the picture count less, down to a quarter in its corners.
/// @param from_centre  distance in half diagonals of the picture
float focus_at(double from_centre);

/// Triangles that a view-dependent object (a fan-hierarchy) may have for its share: its Budgets::triangles.
inline std::uint64_t triangle_budget(float r, double triangles) {
  return static_cast<std::uint64_t>(double(r) * triangles);
}

/// What is asked of one frame.
struct FrameTask {
  double deadline_ms = 0;
  FrameWork fixed;  ///< what does not depend on the choice; its triangles are 0
};

class ResolutionPolicy {
 public:
  virtual ~ResolutionPolicy() = default;
  /// @param r  one per object; r_min ≤ r ≤ 1. Where not even r_min of all fits the deadline, the predictive
  /// policy gives 0 to those of least interest: they are not to be drawn (outcome infeasible).
  /// @param out_of_time  ends the choice early, with a feasible answer
  /// @cost O(objects). No allocation after warm-up.
  virtual ResolutionOutcome choose(const VisibleObjects& objects, const FrameTask& task, std::span<float> r,
                                   const std::function<bool()>& out_of_time) = 0;
  /// What the frame took whose resolutions were chosen last.
  virtual void measured(double ms, double deadline_ms) = 0;
};

struct PredictiveOptions {
  double alpha = 1;        ///< of ResolutionProblem
  double quantile = 0.99;  ///< share of frames that must keep the deadline
};

struct StressOptions {
  double alpha = 0.4;                     ///< step of the stress, within (0, 1); TOM's figure 9
  double load_min = 0.5, load_max = 1.0;  ///< no change between
  double full_coverage = 1;               ///< share of the picture from which r = 1, at stress 1
};

/// @param costs  outlives the policy; the caller lets it observe each frame
std::unique_ptr<ResolutionPolicy> predictive_policy(const CostModel& costs,
                                                    const PredictiveOptions& options = {});
std::unique_ptr<ResolutionPolicy> stress_policy(const StressOptions& options = {});
std::unique_ptr<ResolutionPolicy> fixed_policy(double full_coverage = 1);

}  // namespace cuesta
