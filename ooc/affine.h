#pragma once
/// Affine maps of 3-space in f64: how nodes of a scene lie in their parents.

#include <array>

#include "ooc/vec.h"

namespace cuesta {

/// point ↦ columns · point + translation. 96 bytes.
struct Affine {
  std::array<Vec3d, 3> columns{Vec3d{1, 0, 0}, Vec3d{0, 1, 0}, Vec3d{0, 0, 1}};
  Vec3d translation;

  Vec3d vector(Vec3d v) const { return columns[0] * v.x + columns[1] * v.y + columns[2] * v.z; }
  Vec3d point(Vec3d p) const { return vector(p) + translation; }
  friend bool operator==(const Affine&, const Affine&) = default;
};

/// `outer` after `inner`.
inline Affine operator*(const Affine& outer, const Affine& inner) {
  return {{outer.vector(inner.columns[0]), outer.vector(inner.columns[1]), outer.vector(inner.columns[2])},
          outer.point(inner.translation)};
}

/// < 0: the map turns counter-clockwise triangles round; 0: it flattens space.
inline double determinant(const Affine& a) {
  return dot(a.columns[0], cross(a.columns[1], a.columns[2]));
}

/// The inverse transpose times |determinant|: where normals go, but for their length. Also of a map that
/// flattens.
inline Vec3d map_normal(const Affine& a, Vec3d n) {
  const Vec3d turned = cross(a.columns[1], a.columns[2]) * n.x + cross(a.columns[2], a.columns[0]) * n.y +
                       cross(a.columns[0], a.columns[1]) * n.z;
  return determinant(a) < 0 ? -turned : turned;
}

/// The map that undoes `a`; of one that flattens space, `a` itself.
inline Affine inverse(const Affine& a) {
  const double d = determinant(a);
  if (d == 0) return a;
  const Vec3d r0 = cross(a.columns[1], a.columns[2]) / d, r1 = cross(a.columns[2], a.columns[0]) / d,
              r2 = cross(a.columns[0], a.columns[1]) / d;
  Affine out;
  out.columns = {Vec3d{r0.x, r1.x, r2.x}, Vec3d{r0.y, r1.y, r2.y}, Vec3d{r0.z, r1.z, r2.z}};
  out.translation = -out.vector(a.translation);
  return out;
}

/// The box around the image of a box; of an empty one, empty. @cost eight points
inline Box3d map_box(const Affine& a, const Box3d& box) {
  Box3d out;
  if (box.empty()) return out;
  for (int corner = 0; corner < 8; ++corner) {
    out.add(a.point({corner & 1 ? box.hi.x : box.lo.x, corner & 2 ? box.hi.y : box.lo.y,
                     corner & 4 ? box.hi.z : box.lo.z}));
  }
  return out;
}

}  // namespace cuesta
