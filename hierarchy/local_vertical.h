#pragma once
/// The vertical of a field of heights about a cell's own corner, in f32.

#include "ooc/vec.h"
#include "ooc/vertical.h"

namespace cuesta {

/// up(p) is linear in p: its direction is that of Vertical::direction() to within 1e-7, its length near 1.
struct LocalVertical {
  LocalVertical(const Vertical& vertical, Vec3i origin) : axis(vec_cast<float>(vertical.axis)) {
    const Vec3d d = vertical.direction(vec_cast<double>(origin));
    up_at_origin = vec_cast<float>(normalized(d));
    if (vertical.is_plane) return;
    is_plane = false;
    per_length = static_cast<float>(1 / length(d));
    stretch = static_cast<float>(vertical.stretch);
  }
  Vec3f up(Vec3f p) const { return up_at_origin + (p + axis * (stretch * dot(p, axis))) * per_length; }

  bool is_plane = true;
  Vec3f up_at_origin, axis;
  float per_length = 0, stretch = 0;
};

}  // namespace cuesta
