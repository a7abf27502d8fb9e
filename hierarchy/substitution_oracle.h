#pragma once
/// Oracles of the greedy framework (greedy_substitution.h): which substitutions are candidates, and legal.

#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "hierarchy/nearest_points.h"
#include "hierarchy/substitution_kernel.h"

namespace cuesta {

/// Along edges; topology is kept until the kernel lets it go.
class EdgeOracle {
 public:
  explicit EdgeOracle(SubstitutionKernel& kernel) : kernel_(kernel) {}

  std::span<const PointId> candidates(PointId u) {
    return kernel_.neighbours(u);
  }
  bool legal(PointId u, PointId v) { return kernel_.legal(u, v); }
  void applied(PointId, PointId) {}

 private:
  SubstitutionKernel& kernel_;
};

}  // namespace cuesta
