#pragma once
/// Samples of the original surface on their way through substitutions: each is kept by the triangle that is
/// nearest to it, and says how far the surface has moved there (deviation.h, I5).

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "hierarchy/cell_mesh.h"
#include "hierarchy/deviation.h"
#include "hierarchy/substitution_kernel.h"

namespace cuesta {

/// Share added to the deviations of a cell whose samples were chosen from more (max_triangle_samples): what
/// one that was left out may lie farther away than all that were kept. Measured, not proven:
/// docs/design-notes.md.
inline constexpr float chosen_samples_margin = 1.0f / 12;

/// 12 bytes per sample, twice while they move; 8 per triangle.
class SurfaceSamples {
 public:
  /// @param samples  none: the points themselves are all there are, once they have left
  /// @param kernel   at the start; outlives this
  SurfaceSamples(const TriangleSamples& samples, const SubstitutionKernel& kernel);

  /// The largest distance from the targets, grid units, rounded up, not below least_error.
  float measure(const Replacement& r);
  /// Hands the samples measured last to their nearest targets. @pre measure(r) was the last call
  void move(const Replacement& r);
  /// Whether samples have been left out, so that measure() is an estimate.
  bool has_chosen() const { return chosen_; }
  std::span<const Vec3f> of(TriangleId t) const { return {arena_.data() + runs_[t].begin, runs_[t].count}; }

 private:
  /// arena_[begin] … [begin + count - 1].
  struct Run {
    std::uint32_t begin = 0, count = 0;
  };
  void pack();

  std::span<const Vec3f> positions_;
  std::vector<Run> runs_;     // per triangle
  std::vector<Vec3f> arena_;  // only grows, until it is packed
  std::size_t live_ = 0;
  bool chosen_ = false;  // some triangle has as many samples as it may: others will have been left out

  // Scratch of one substitution.
  DeviationBatch batch_;
  std::vector<std::array<Vec3f, 3>> corners_;
  std::vector<std::uint32_t> fill_;
};

}  // namespace cuesta
