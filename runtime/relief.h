#pragma once
/// Which way is up above a plane or an ellipsoid, how high a point is, and where it is when heights are
/// exaggerated.
///
/// Units are those of the points. Heights above an ellipsoid of the Earth's shape are right within 1e-5 of
/// themselves up to 100 km, and everywhere to what a picture needs; a plane's are exact. The renderer's
/// shader uses the same formulas. Threads: const calls are concurrent.

#include <array>

#include "ooc/grid.h"
#include "ooc/vec.h"

namespace cuesta {

struct Relief {
  /// A point of height 0 of a plane; the centre of an ellipsoid.
  Vec3d origin = {};
  /// Unit and right-handed. A plane's east, north and up; an ellipsoid's two equatorial axes and its north
  /// pole.
  std::array<Vec3d, 3> axes{Vec3d{1, 0, 0}, Vec3d{0, 1, 0}, Vec3d{0, 0, 1}};
  double equatorial_radius = 0, polar_radius = 0;  ///< 0: a plane
  double exaggeration = 1;                         ///< > 0: points are drawn at this times their height

  bool is_plane() const { return equatorial_radius == 0; }
  double height(Vec3d p) const;
  Vec3d up(Vec3d p) const;     ///< unit
  Vec3d north(Vec3d p) const;  ///< unit and level; any level direction at the poles
  /// Where a point is drawn.
  Vec3d raised(Vec3d p) const { return p + up(p) * ((exaggeration - 1) * height(p)); }
  /// Its inverse, within 1e-6 of the height.
  Vec3d lowered(Vec3d p) const;

  /// The same in units of a grid.
  Relief in(const Grid& grid) const;

  friend bool operator==(const Relief&, const Relief&) = default;
};

}  // namespace cuesta
