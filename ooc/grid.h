#pragma once
/// The quantisation grid that all pages of a file share: a vertex has integer coordinates, so vertices shared by
/// pages decode bit-identically, and the stored mesh is the mesh whose errors were measured.

#include "ooc/vec.h"

namespace cuesta {

/// world = origin + step · grid, in f64, in the input's units. Grid coordinates are within ±2^30.
struct Grid {
  Vec3d origin;
  double step = 1;  ///< > 0, the same on the three axes

  Vec3d world(Vec3i g) const { return origin + vec_cast<double>(g) * step; }
  /// Nearest grid point; ties go up. The position error is at most step·√3/2.
  Vec3i snap(Vec3d w) const {
    const Vec3d g = (w - origin) / step;
    return {static_cast<std::int32_t>(std::floor(g.x + 0.5)), static_cast<std::int32_t>(std::floor(g.y + 0.5)),
            static_cast<std::int32_t>(std::floor(g.z + 0.5))};
  }
};

}  // namespace cuesta
