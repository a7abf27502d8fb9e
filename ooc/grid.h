#pragma once
/// The quantisation grid that all pages of a file share: a vertex has integer coordinates, so vertices shared
/// by pages decode bit-identically, and the stored mesh is the mesh whose errors were measured.

#include "ooc/vec.h"

namespace cuesta {

/// world = origin + step · grid, in f64, in the input's units. Grid coordinates are within ±2^30.
struct Grid {
  Vec3d origin;
  double step = 1;  ///< > 0, the same on the three axes

  Vec3d world(Vec3i g) const { return origin + vec_cast<double>(g) * step; }
  /// Largest distance between a point and where it is snapped to: half the cube's diagonal. World units.
  /// A guaranteed error against the input is a file's error plus this.
  double snap_error() const { return step * 0.8660254037844387; }
  /// Nearest grid point; ties go up.
  Vec3i snap(Vec3d w) const {
    const Vec3d g = (w - origin) / step;
    return {static_cast<std::int32_t>(std::floor(g.x + 0.5)),
            static_cast<std::int32_t>(std::floor(g.y + 0.5)),
            static_cast<std::int32_t>(std::floor(g.z + 0.5))};
  }
};

}  // namespace cuesta
