#pragma once
/// What a substitution costs by the planes that its vertex stands for (quadric.h).

#include <span>
#include <vector>

#include "hierarchy/quadric.h"
#include "hierarchy/substitution_kernel.h"

namespace cuesta {

/// 64 bytes per point.
class QuadricCost {
 public:
  /// @param kernel  at the start; outlives this
  explicit QuadricCost(const SubstitutionKernel& kernel);

  /// Cost of u → v: area-weighted squared distance to the planes u stands for, over the root of the
  /// area. (Measured on the bunny at 1 % of the triangles: undivided +2 % mean error; divided by the area,
  /// the mean squared distance, equal here and +3 % at 0.5 %.) Unit: grid units to the third power. Of a
  /// field of heights the mean squared vertical distance, seen from above: square grid units.
  float operator()(PointId u, PointId v) const {
    const Mover& m = movers_[u];
    return m.quadric.at(position_[v] - m.position) / m.divisor;
  }
  /// u → v has been applied: v stands for the planes of u, too.
  void applied(PointId u, PointId v) {
    movers_[v].quadric.add(movers_[u].quadric, position_[u] - position_[v]);
    set_divisor(v);
  }

 private:
  /// What the cost of moving a point needs of it: one cache line.
  struct alignas(64) Mover {
    Quadric quadric;
    float divisor = 0;  ///< of the quadric's value
    Vec3f position;
  };
  void set_divisor(PointId p);

  std::span<const Vec3f> position_;
  bool is_mean_;  // of a field of heights
  std::vector<Mover> movers_;
};

}  // namespace cuesta
