#pragma once
/// Oracles of the greedy framework (greedy_substitution.h): which substitutions are candidates, and legal.

#include <cstdint>
#include <span>
#include <vector>

#include "hierarchy/substitution_kernel.h"

namespace cuesta {

/// Along edges. Topology is kept until the kernel lets it go.
class EdgeOracle {
 public:
  explicit EdgeOracle(SubstitutionKernel& kernel) : kernel_(kernel) {}

  std::span<const PointId> candidates(PointId u) { return kernel_.neighbours(u); }
  bool legal(PointId u, PointId v) { return kernel_.legal(u, v); }
  void applied(PointId, PointId) {}

 private:
  SubstitutionKernel& kernel_;
};

/// Along edges, and between points of different components that are at most a threshold apart: a pair stays a
/// candidate for what its points have gone to. Source: TOM §4.1. Deviation: pairs within a component, which
/// join nothing, are not looked at, and of those of a point only the nearest ones.
class PairOracle {
 public:
  static constexpr std::size_t most_partners = 8;

  /// Lets topology go. @param threshold  grid units, ≥ 0
  PairOracle(SubstitutionKernel& kernel, float threshold);

  /// Without doubles.
  std::span<const PointId> candidates(PointId u);
  bool legal(PointId u, PointId v) {
    return kernel_.adjacent(u, v) ? kernel_.legal(u, v) : kernel_.legal_pair(u, v);
  }
  void applied(PointId u, PointId v);

 private:
  void find_partners(float threshold);
  PointId current(PointId p);

  SubstitutionKernel& kernel_;
  std::vector<std::vector<PointId>> partners_;  // per point
  std::vector<PointId> gone_to_;                // per point: itself while it is there
  std::vector<PointId> candidates_;
};

}  // namespace cuesta
