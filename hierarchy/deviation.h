#pragma once
/// Measured deviation: how far samples of the original surface lie from the triangles that replace it (I5).

#include <cstdint>
#include <span>
#include <vector>

#include "ooc/vec.h"

namespace cuesta {

/// Points in structure-of-arrays form, with the squared distance to, and the index of, the nearest triangle so far.
/// Filled, measured and read back within one substitution; reused, so it does not allocate after warm-up.
class DeviationBatch {
 public:
  void clear() { size_ = 0; }
  std::size_t size() const { return size_; }
  void add(Vec3f p);

  /// Distances to triangle (a, b, c); a point that is nearer to it than to all before takes `index`.
  /// Exact up to float rounding of coordinate differences. @cost about 1 ns per point with AVX2.
  void measure(Vec3f a, Vec3f b, Vec3f c, std::int32_t index);

  float squared_distance(std::size_t i) const { return best_[i]; }
  std::int32_t nearest(std::size_t i) const { return nearest_[i]; }
  Vec3f point(std::size_t i) const { return {x_[i], y_[i], z_[i]}; }
  /// Largest squared distance over all points; 0 when empty.
  float worst_squared() const;

 private:
  void grow();
  std::size_t size_ = 0;
  std::vector<float> x_, y_, z_, best_;
  std::vector<std::int32_t> nearest_;
};

}  // namespace cuesta
