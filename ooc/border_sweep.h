#pragma once
/// Joins points that are near each other, any number of them in little memory: a sweep through space that
/// holds what is within twice the tolerance.

#include <cstdint>
#include <deque>
#include <unordered_map>
#include <utility>
#include <vector>

#include "ooc/vec.h"

namespace cuesta {

/// Some points become *centres*: in the order of the sweep, each that has no centre within the tolerance
/// before it. Every point then goes to its nearest centre, the first of equally near ones. So no point moves
/// farther than the tolerance, centres are farther than that from each other, and the result is a function of
/// the set of points and the tolerance alone.
///
/// What is joined are points near each other, whatever lies between them. Two borders close if their points
/// are pairs within the tolerance, or if the tolerance spans more than the distance of their points; along a
/// border, points nearer than the tolerance become one.
class BorderSweep {
 public:
  /// Points are swept in ascending order of this, then of position. Its planes are oblique, as borders of
  /// tiles tend to lie in planes along the axes, which would come all at once.
  static std::int64_t order(Vec3i p) {
    return std::int64_t{577} * p.x + std::int64_t{408} * p.y + std::int64_t{239} * p.z;
  }
  /// Points within `tolerance` of each other differ by no more in order.
  static std::int64_t reach_of(double tolerance);

  /// @param tolerance  grid steps, ≥ 1
  explicit BorderSweep(double tolerance);

  /// The next point. @pre coordinates in [0, 2^30); each point once, in order.
  void add(Vec3i p);
  /// No more points come.
  void finish() { settle(nullptr); }
  /// Takes the next point, in the order in which they were added, and where it goes (itself, for most).
  bool take(std::pair<Vec3i, Vec3i>& point_and_centre);

 private:
  struct Hash {
    std::size_t operator()(const Vec3i& c) const {
      return (static_cast<std::size_t>(c.x) * 0x9E3779B97F4A7C15u + static_cast<std::size_t>(c.y)) *
                 0xC2B2AE3D27D4EB4Fu +
             static_cast<std::size_t>(c.z) * 0x165667B19E3779F9u;
    }
  };
  Vec3i cell_of(Vec3i p) const { return {p.x / cell_, p.y / cell_, p.z / cell_}; }
  /// The nearest centre within the tolerance, if any.
  const Vec3i* nearest(Vec3i p) const;
  /// Finds the centres of points that nothing after `next` can change; null: of all.
  void settle(const Vec3i* next);
  void forget(Vec3i centre);

  std::int64_t reach_ = 0, most_square_ = 0;
  std::int32_t cell_ = 1;  ///< at least twice the tolerance: what is within it lies in 8 cells
  std::deque<Vec3i> waiting_;
  std::deque<std::pair<Vec3i, Vec3i>> settled_;
  std::deque<Vec3i> centres_;  ///< in order
  std::unordered_map<Vec3i, std::vector<Vec3i>, Hash> cells_;
};

}  // namespace cuesta
