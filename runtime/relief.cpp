#include "runtime/relief.h"

namespace cuesta {
namespace {

/// Along the axes, in radii: of length 1 on the ellipsoid.
Vec3d in_radii(const Relief& r, Vec3d p) {
  const Vec3d d = p - r.origin;
  return {dot(d, r.axes[0]) / r.equatorial_radius, dot(d, r.axes[1]) / r.equatorial_radius,
          dot(d, r.axes[2]) / r.polar_radius};
}

/// Of half the squared length in radii.
Vec3d gradient(const Relief& r, Vec3d q) {
  return r.axes[0] * (q.x / r.equatorial_radius) + r.axes[1] * (q.y / r.equatorial_radius) +
         r.axes[2] * (q.z / r.polar_radius);
}

}  // namespace

double Relief::height(Vec3d p) const {
  if (is_plane()) return dot(p - origin, axes[2]);
  const Vec3d q = in_radii(*this, p);
  const double slope = length(gradient(*this, q)), size = length(q);
  return slope > 0 ? (size - 1) * size / slope : -polar_radius;  // exact on a sphere
}

Vec3d Relief::up(Vec3d p) const {
  if (is_plane()) return axes[2];
  const Vec3d g = gradient(*this, in_radii(*this, p));
  return dot(g, g) > 0 ? normalized(g) : axes[2];
}

Vec3d Relief::north(Vec3d p) const {
  if (is_plane()) return axes[1];
  const Vec3d above = up(p), level = axes[2] - above * dot(axes[2], above);
  return dot(level, level) > 1e-24 ? normalized(level) : axes[0];
}

Vec3d Relief::lowered(Vec3d p) const {
  if (exaggeration == 1) return p;
  constexpr int rounds = 4;  // each leaves 1e-3 of the error or less
  Vec3d low = p - up(p) * ((1 - 1 / exaggeration) * height(p));
  if (is_plane()) return low;
  for (int i = 0; i < rounds; ++i) {
    const Vec3d above = up(low), off = p - raised(low);
    const double rise = dot(off, above);
    low = low + (off - above * rise) + above * (rise / exaggeration);
  }
  return low;
}

Relief Relief::in(const Grid& grid) const {
  Relief r = *this;
  r.origin = (origin - grid.origin) / grid.step;
  r.equatorial_radius = equatorial_radius / grid.step;
  r.polar_radius = polar_radius / grid.step;
  return r;
}

}  // namespace cuesta
