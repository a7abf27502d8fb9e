#pragma once
/// How much of an error is seen: all of it at silhouettes and where light grazes, less of it where the
/// surface faces both eye and light. Source: Livny et al., "Dual adaptive paths for multiresolution
/// hierarchies", 2006, eq. 3; theirs is a tolerance per vertex, ours a factor per page, bounded over all its
/// normals and all directions to it, so that it stays monotone (I3).

#include <optional>
#include <span>

#include "hierarchy/error_code.h"
#include "ooc/vec.h"

namespace cuesta {

/// All normals within `angle_rad` of `axis`, a unit vector; π: any.
struct NormalCone {
  Vec3f axis{0, 0, 1};
  float angle_rad = 3.14159274f;

  static NormalCone around(std::span<const Vec3f> unit_normals);
};

struct VisualError {
  double facing_factor =
      1;  ///< ≥ 1: errors of what faces eye and light count so many times less; 1: all count
  std::optional<Vec3d> light = {};  ///< towards it, world; without, only the eye counts

  bool on() const { return facing_factor > 1; }
  /// From 1, where a normal of the cone may be across the direction to the eye or the light, to
  /// facing_factor; one of the powers of 1.25, rounded down, so that it seldom changes. Nested cones and
  /// balls never have the smaller factor.
  double page_factor(const NormalCone& normals, const Sphere& bound, Vec3d eye) const;

  friend bool operator==(const VisualError&, const VisualError&) = default;
};

}  // namespace cuesta
