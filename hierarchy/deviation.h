#pragma once
/// Measured deviation: how far samples of the original surface lie from the triangles that replace it (I5).

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "hierarchy/vertical_deviation.h"
#include "ooc/vec.h"

namespace cuesta {

/// Points in structure-of-arrays form, with the squared distance to, and the index of, the nearest triangle
/// so far. Filled, then measured and read back within one substitution; reused, so it does not allocate after
/// warm-up.
///
/// With a vertical the nearest triangle is the one that a point's vertical goes through, and the distance is
/// along it. Where it goes through none (a border has moved), it is the distance to the point of the outline
/// that is nearest to the vertical: not less than the difference of heights there, nor than how far the
/// border has moved.
class DeviationBatch {
 public:
  explicit DeviationBatch(std::optional<LocalVertical> vertical = {}) : vertical_(vertical) {}

  /// What f32 arithmetic may take away from a distance: a share of it, and a share of the triangles' longest
  /// edge.
  static constexpr float relative_rounding = 1e-5f;
  static constexpr float rounding_per_length = 0x1p-20f;
  /// Grid units that nobody asks for: flat stays flat if no more than this could have been rounded away.
  static constexpr float negligible = 0x1p-6f;

  void clear() {
    size_ = 0;
    measured_ = false;
    rounding_ = 0;
  }
  std::size_t size() const { return size_; }
  void add(Vec3f p) {
    if (size_ == x_.size()) grow();
    x_[size_] = p.x;
    y_[size_] = p.y;
    z_[size_] = p.z;
    ++size_;
  }
  void add(std::span<const Vec3f> points) {
    while (size_ + points.size() > x_.size()) grow();
    float *x = x_.data() + size_, *y = y_.data() + size_, *z = z_.data() + size_;
    for (std::size_t i = 0; i < points.size(); ++i) {
      x[i] = points[i].x;
      y[i] = points[i].y;
      z[i] = points[i].z;
    }
    size_ += points.size();
  }

  /// Distances to the triangles; a point that is nearer to triangle i than to all before takes first_index +
  /// i. With a vertical it is called once: the triangles are all that there are. Coordinates are integers
  /// below 2^24; exact up to the rounding named above. @cost about 1 ns per point and triangle with AVX2,
  /// points in eights.
  void measure(std::span<const std::array<Vec3f, 3>> triangles, std::int32_t first_index = 0);
  void measure(Vec3f a, Vec3f b, Vec3f c, std::int32_t index) {
    const std::array<Vec3f, 3> corners{a, b, c};
    measure({&corners, 1}, index);
  }

  float squared_distance(std::size_t i) const { return best_[i]; }
  std::int32_t nearest(std::size_t i) const { return nearest_[i]; }
  std::span<const std::int32_t> nearest() const { return {nearest_.data(), size_}; }
  Vec3f point(std::size_t i) const { return {x_[i], y_[i], z_[i]}; }
  /// How far the vertical of a point is inside its nearest triangle; as VerticalPoints::inside.
  float inside(std::size_t i) const { return inside_[i]; }
  /// Upper bound of the distance of a point.
  float bound(std::size_t i) const { return bound_of(best_[i]); }
  /// Upper bound of the largest distance over all points, to within `negligible`; 0 if they are found to lie
  /// on the triangles, or there are none.
  float worst_bound() const;

 private:
  void grow();
  float bound_of(float squared) const;
  void measure_nearest(std::span<const std::array<Vec3f, 3>> triangles, std::int32_t first_index);
  void measure_along_vertical(std::span<const std::array<Vec3f, 3>> triangles, std::int32_t first_index);
  void measure_beside(std::span<const std::array<Vec3f, 3>> triangles, std::int32_t first_index);

  std::optional<LocalVertical> vertical_;
  std::size_t size_ = 0;
  bool measured_ = false;
  float rounding_ = 0;  // that f32 arithmetic may take away from any distance
  std::vector<float> x_, y_, z_, best_;
  std::vector<float> up_x_, up_y_, up_z_, inside_;  // with a vertical
  std::vector<std::int32_t> nearest_;
};

}  // namespace cuesta
