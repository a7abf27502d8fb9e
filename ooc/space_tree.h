#pragma once
/// Space cut into boxes that hold about equally many points: a kd-tree over a sample of them.

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "ooc/vec.h"

namespace cuesta {

/// Three orthonormal axes to cut along.
using Axes = std::array<Vec3f, 3>;
inline constexpr Axes identity_axes{Vec3f{1, 0, 0}, Vec3f{0, 1, 0}, Vec3f{0, 0, 1}};

inline Vec3f turn(const Axes& f, Vec3f p) {
  return {dot(p, f[0]), dot(p, f[1]), dot(p, f[2])};
}

/// Immutable; const calls are concurrent. A point belongs to exactly one leaf. All arithmetic is f32 on the
/// turned point, so that leaf_of() and leaf_box() agree to the bit.
class SpaceTree {
 public:
  /// Cuts at sample medians across the longest extent. Fewer leaves if the samples coincide.
  /// @param samples  any points, not turned; none gives one leaf
  /// @param leaves   ≥ 1
  /// @cost O(samples · log leaves), deterministic in the order of samples
  SpaceTree(std::vector<Vec3f> samples, std::uint32_t leaves, const Axes& axes);

  std::uint32_t leaf_count() const { return static_cast<std::uint32_t>(boxes_.size()); }
  const Axes& axes() const { return axes_; }
  /// @param turned  turn(axes(), point)
  std::uint32_t leaf_of(Vec3f turned) const;
  /// Turned points p of the leaf have lo ≤ p < hi; outermost sides are infinite.
  const Box3<float>& leaf_box(std::uint32_t leaf) const { return boxes_[leaf]; }

 private:
  struct Node {
    float cut = 0;
    std::int32_t axis = -1;   ///< -1: a leaf
    std::uint32_t right = 0;  ///< the left child follows its parent; of a leaf: its number
  };
  void split(std::span<Vec3f> samples, std::uint32_t leaves, const Box3<float>& box);

  Axes axes_;
  std::vector<Node> nodes_;
  std::vector<Box3<float>> boxes_;
};

inline bool holds(const Box3<float>& box, Vec3f p) {
  return p.x >= box.lo.x && p.x < box.hi.x && p.y >= box.lo.y && p.y < box.hi.y && p.z >= box.lo.z &&
         p.z < box.hi.z;
}

}  // namespace cuesta
