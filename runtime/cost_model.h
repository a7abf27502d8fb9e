#pragma once
/// What a frame will take, from what it draws: calibrated once, then refined by every frame that is measured.
/// Source: Gobbetti, Scateni, Agus, "Exploring Virtual Prototypes Using Time-Critical Multiresolution
/// Rendering", §3.1 (the cost heuristic: linear, with a fill-rate term). Deviations: the costs are fitted,
/// not given; what deadlines ask for is a quantile, not the mean. The runtime has no clock: a caller measures
/// and hands in.

#include <array>
#include <cstdint>
#include <span>
#include <vector>

namespace cuesta {

/// What one frame draws; known before it is drawn.
struct FrameWork {
  double objects = 0;
  double triangles = 0;
  double fragments =
      0;  ///< rasterised, hidden or not, beyond 16 of each triangle; a guess before they are drawn
  double pixels = 0;  ///< written, with what is overdrawn; a guess before they are drawn
  double changed_triangles =
      0;  ///< whose indices, and vertices that, are made and uploaded anew for this frame
};

struct MeasuredFrame {
  FrameWork work;
  double ms = 0;
  FrameWork guess = work;  ///< the work as it was known before it was drawn
};

/// frame_ms = costs · (1, objects, triangles, fragments, pixels, changed triangles), no cost negative.
/// Least squares of the relative deviation in which a frame counts 0.98 times what the next one does. A
/// deviation beyond 3 robust standard deviations counts as one of 3. What frames do not tell apart, as where
/// all have the same pixels, stays near the calibration.
class CostModel {
 public:
  static constexpr std::size_t terms = 6;
  using Costs = std::array<double, terms>;  ///< ms: of a frame, and of one of each of FrameWork

  /// @param measured  frames of different content, the more the better; ms > 0, work finite and ≥ 0.
  /// None: costs of a slow software renderer, until there are frames.
  explicit CostModel(std::span<const MeasuredFrame> measured = {});

  const Costs& costs() const { return costs_; }
  double object_ms() const { return costs_[1]; }
  double triangle_ms() const { return costs_[2]; }
  double fragment_ms() const { return costs_[3]; }
  double pixel_ms() const { return costs_[4]; }
  double changed_triangle_ms() const { return costs_[5]; }
  /// Half of all frames take less, about.
  double predict_ms(const FrameWork& work) const;
  /// Measured over predicted time: what a share `quantile` of the last 48 frames, calibration included,
  /// stays below. Where they are too few to tell, as for 99 %, the largest and a quarter more. Within [1,
  /// most_ratio].
  double ratio(double quantile) const;
  /// Beyond it is not the model's uncertainty but a machine that does something else.
  static constexpr double most_ratio = 2;

  /// @param ms  what the frame took; ignored unless finite and > 0.   @cost O(1): about 3 µs. No allocation
  /// after warm-up.
  /// @param guess  the work as it was known before it was drawn: ratio() is over what that came to
  void observe(const FrameWork& work, double ms, const FrameWork& guess);
  void observe(const FrameWork& work, double ms) { observe(work, ms, work); }

 private:
  using Matrix = std::array<Costs, terms>;
  void weigh_in(const Costs& x, double ms, double weight);
  void fit();
  void remember(double ratio);

  Costs calibrated_{}, costs_{};
  Matrix information_{};  // Σ weight · x xᵀ
  Costs target_{};        // Σ weight · x · ms
  double spread_ = 0.1;   // running median of the relative deviation
  std::vector<double> ratios_;
  std::size_t next_ratio_ = 0;
  mutable std::vector<double> ordered_;
};

}  // namespace cuesta
