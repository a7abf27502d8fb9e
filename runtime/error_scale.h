#pragma once
/// From errors in the model to errors on the screen, monotone under saturation (I3).

#include <array>
#include <optional>

#include "hierarchy/error_code.h"
#include "ooc/grid.h"
#include "runtime/view.h"

namespace cuesta {

/// sse = error / scale(sphere): how many grid units make one pixel at the point of the sphere nearest to the
/// eye. A sphere inside another never has the smaller scale, so with saturated errors a test of each
/// substitution alone gives a legal cut. Evaluated in f64; equal spheres tie exactly, nested ones have a
/// margin (error_code.h, contains()).
class ErrorScale {
 public:
  /// Uniform cuts: sse is the error itself, in world units.
  static ErrorScale uniform(const Grid& grid);
  /// Perspective view. Spheres wholly outside the view frustum, widened by `margin` times its half-angles,
  /// count `outside_factor` times less; 1 makes the whole surface count.
  static ErrorScale perspective(const Grid& grid, const View& view, double outside_factor = 1,
                                double margin = 0.15);

  double scale(const Sphere& s) const;
  /// Screen-space error in pixels (uniform: in world units): 0 for no error, +infinity with the eye in the
  /// sphere.
  double sse(float error, const Sphere& s) const {
    return error == 0 ? 0 : static_cast<double>(error) / scale(s);
  }

 private:
  bool outside(Vec3d to_centre, double radius) const;
  bool uniform_ = true;
  double unit_ = 1;  // uniform: scale; perspective: 1 / pixels per unit at distance one
  double outside_factor_ = 1;
  Vec3d eye_;                      // grid units
  std::array<Vec3d, 5> planes_{};  // inward unit normals of the frustum's sides and the plane through the eye
};

}  // namespace cuesta
