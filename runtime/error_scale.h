#pragma once
/// From errors in the model to errors on the screen, monotone under saturation (I3).

#include <array>
#include <optional>

#include "hierarchy/error_code.h"
#include "ooc/grid.h"
#include "runtime/relief.h"
#include "runtime/surface_part.h"
#include "runtime/view.h"

namespace cuesta {

/// sse = error / scale(sphere): how many grid units make one pixel at the point of the sphere nearest to the
/// eye. A sphere inside another never has the smaller scale, so with saturated errors a test of each
/// substitution alone gives a legal cut. Evaluated in f64; equal spheres tie exactly, nested ones have a
/// margin (error_code.h, contains()).
class ErrorScale {
 public:
  /// Nothing nearer than this is drawn, grid units: an eye in a sphere sees it from there.
  static constexpr double nearest = 0.5;

  /// Uniform cuts: sse is the error itself, in world units.
  static ErrorScale uniform(const Grid& grid);
  /// Uniform within a part: outside no error counts, and on its borders each counts 1 / border_share times,
  /// so that parts meet. Cuts of two parts with a border in common agree, at one tau, on all triangles that
  /// touch it, and at other taus to within border_share times their sum.   @pre 0 < border_share ≤ 1.
  static ErrorScale part(const Grid& grid, SurfacePart part, double border_share);
  /// Perspective view. Pages wholly outside the view frustum, widened by `margin` times its half-angles,
  /// count `outside_factor` times less; 1 makes the whole surface count. (By pages, whose bounds contain
  /// those of the finer pages that lean on them: so a factor is monotone too, and the test of a substitution
  /// needs no planes.)
  static ErrorScale perspective(const Grid& grid, const View& view, double outside_factor = 1,
                                double margin = 0.15);

  /// The same view of a surface whose heights are drawn exaggerated (relief.h). Errors grow by the factor F,
  /// and the eye is brought to where the surface is as it is stored: a point there is no farther from it than
  /// it is drawn, times F or 1 / F, whichever is larger. So no error is larger on the screen than told; seen
  /// from high above, it is up to F times smaller. On an ellipsoid that holds within 1 % for heights up to 1
  /// % of its radius over F.
  ErrorScale exaggerated(const Grid& grid, const Relief& relief) const;

  /// Grid units per pixel (uniform: per world unit) at the sphere, times the factor of its page.
  double scale(const Sphere& s, double page_factor = 1) const {
    return uniform_ ? unit_ * share(s) : near(s) * unit_ * page_factor;
  }
  /// Screen-space error in pixels (uniform: in world units); 0 for no error.
  double sse(float error, const Sphere& s, double page_factor = 1) const {
    return error == 0 ? 0 : static_cast<double>(error) / scale(s, page_factor);
  }
  /// For everything in a page with this bound: 1, or outside_factor.
  double page_factor(const Sphere& bound) const;
  /// True if the ball is wholly outside the view frustum itself.
  bool invisible(const Sphere& bound) const;

  bool is_uniform() const { return uniform_; }
  /// By how much a uniform scale is larger for all spheres in the ball: 1, or infinity outside of a part;
  /// nothing where they differ, on its borders.
  std::optional<double> same_within(const Sphere& bound) const;
  Vec3d eye() const { return eye_; }  ///< grid units
  /// Grid units of error per pixel and grid unit of distance; uniform: per world unit.
  double unit() const { return unit_; }
  /// Distance of the eye from the sphere, at least `nearest`.
  double near(const Sphere& s) const;

  /// The same view, seen from elsewhere.
  ErrorScale moved(Vec3d by_grid_units) const;

  friend bool operator==(const ErrorScale&, const ErrorScale&) = default;

 private:
  bool uniform_ = true;
  double unit_ = 1;  // uniform: scale; perspective: 1 / pixels per unit at distance one
  double outside_factor_ = 1;
  std::optional<SurfacePart> part_;  // uniform cuts
  double border_share_ = 1;
  Vec3d eye_{};                   // grid units
  std::optional<Relief> relief_;  // grid units; if heights are exaggerated
  // Inward unit normals of the sides of the frustum, widened and not, and of the plane through the eye.
  std::array<Vec3d, 5> wide_{}, sides_{};

  double share(const Sphere& s) const;
  bool outside(const std::array<Vec3d, 5>& planes, const Sphere& bound) const;
};

}  // namespace cuesta
