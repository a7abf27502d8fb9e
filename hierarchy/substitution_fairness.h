#pragma once
/// Fairness predicates of the greedy framework (greedy_substitution.h): what a substitution costs. Unit: grid
/// steps to the third power.

#include <array>
#include <span>
#include <vector>

#include "hierarchy/quadric_cost.h"
#include "hierarchy/substitution_kernel.h"

namespace cuesta {

/// Distance from the planes that the vertex stands for. Source: Garland, Heckbert, SIGGRAPH 1997 (quadric.h).
class QuadricFairness {
 public:
  explicit QuadricFairness(const SubstitutionKernel& kernel) : planes_(kernel) {}

  void costs(PointId u, std::span<const PointId> targets, std::span<float> out) const {
    for (std::size_t i = 0; i < targets.size(); ++i) out[i] = planes_(u, targets[i]);
  }
  void applied(PointId u, PointId v, std::span<const Child>) { planes_.applied(u, v); }

 private:
  QuadricCost planes_;
};

/// Volume between the surface before and after, plus the edge's length times the change of area, plus
/// penalties for triangles that turn over and for a normal that turns; nothing is remembered.
/// Source: TOM §4.1, which leaves the weights open; these have the least mean error of those tried
/// (docs/design-notes.md).
class MemorylessFairness {
 public:
  static constexpr float area_weight = 0.3f, border_area_weight = 0.9f, inversion_weight = 100,
                         normal_weight = 1;

  explicit MemorylessFairness(const SubstitutionKernel& kernel) : kernel_(kernel) {}

  void costs(PointId u, std::span<const PointId> targets, std::span<float> out);
  void applied(PointId, PointId, std::span<const Child>) {}

  /// A triangle around u: its other corners, and where they are from u.
  struct Side {
    PointId a, b;
    Vec3f from, to, normal;
  };
  /// What some targets would change, side by side: targets are the lanes.
  static constexpr std::size_t lanes = 8;
  struct Change {
    using Lanes = std::array<float, lanes>;
    std::array<PointId, lanes> target;
    Lanes x, y, z;  ///< way from u
    Lanes volume, area, turned, normal_x, normal_y, normal_z;
  };

 private:
  struct Around {
    Vec3f normal;  // unit
    float area;    // twice
  };
  Around collect_sides(PointId u);

  const SubstitutionKernel& kernel_;
  std::vector<Side> sides_;
};

}  // namespace cuesta
