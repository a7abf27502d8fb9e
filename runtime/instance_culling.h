#pragma once
/// Which balls a view may show, and how much of the picture they cover.

#include <array>

#include "ooc/affine.h"
#include "runtime/view.h"

namespace cuesta {

/// Around everything of an instance, in world units.
struct Ball {
  Vec3d centre;
  double radius = 0;
};

/// The ball around a box that a map has turned, stretched and moved; exact where the box's diagonals are
/// equal after it.
Ball ball_of(const Affine& world, const Box3d& box);

/// What a view shows.   Threads: const calls are concurrent.
class ViewCone {
 public:
  explicit ViewCone(const View& view);

  /// False only for balls wholly outside of the picture or behind the eye. May be true for some that are
  /// outside, near a corner.
  bool may_see(const Ball& ball) const;

  struct Footprint {
    double coverage =
        0;  ///< share of the picture that the ball's square covers, clipped to it; 1 around the eye
    double from_centre = 0;  ///< of the ball's nearest point to the picture's centre, in half diagonals of it
    double diameter_px = 0;  ///< infinite around the eye
  };
  Footprint footprint(const Ball& ball) const;

 private:
  Vec3d eye_;
  std::array<Vec3d, 3> frame_;  // right, up, back
  std::array<Vec3d, 4> sides_;  // inward unit normals of planes through the eye
  double pixels_per_unit_, half_width_, half_height_;
};

}  // namespace cuesta
