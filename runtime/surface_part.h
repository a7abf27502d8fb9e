#pragma once
/// A part of space between borders, for cuts that are fine in one place only.

#include <vector>

#include "hierarchy/error_code.h"
#include "ooc/vec.h"

namespace cuesta {

/// A plane, or a cone about an axis. distance() changes by no more than the way between two points, so a ball
/// that reaches over the border has |distance(centre)| ≤ radius.
struct PartBorder {
  Vec3d apex;         ///< on the border, and on the axis of a cone
  Vec3d inward;       ///< plane: unit normal; cone: along the axis, of length √(1 - radial²)
  double radial = 0;  ///< 0 for a plane; else how much the distance grows per unit away from the axis

  /// Positive inside; from the plane, or from the line whose rotation is the cone.
  double distance(Vec3d p) const {
    const Vec3d q = p - apex;
    const double along = dot(inward, q);
    if (radial == 0) return along;
    const double cosine_sq = 1 - radial * radial;
    const Vec3d axial = cosine_sq > 0 ? inward * (along / cosine_sq) : Vec3d{};
    return along + radial * length(q - axial);
  }
  friend bool operator==(const PartBorder&, const PartBorder&) = default;
};

/// Where all distances are positive; grid units. Without borders it is everywhere.
struct SurfacePart {
  std::vector<PartBorder> borders;

  enum class Place { inside, border, outside };

  /// A ball around another is on the border, or where the other one is: so limits that are lowest on the
  /// border and highest outside are monotone (I3).
  Place place(const Sphere& s) const {
    const Vec3d centre = vec_cast<double>(s.centre);
    const double radius = static_cast<double>(s.radius);
    Place place = Place::inside;
    for (const PartBorder& b : borders) {
      const double at = b.distance(centre);
      if (at < -radius) return Place::outside;
      if (at <= radius) place = Place::border;
    }
    return place;
  }
  friend bool operator==(const SurfacePart&, const SurfacePart&) = default;
};

}  // namespace cuesta
