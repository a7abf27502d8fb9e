#pragma once
/// Cameras that show a whole model: for a first picture, and for flights around it. A model is given by
/// points on it, coarse ones will do.

#include <span>

#include "runtime/view.h"

namespace cuesta {

/// Box around points; empty without any.
Box3d box_of(std::span<const Vec3d> points);

/// `view` with the eye and target that show all `points` as large as possible, but for a margin, seen from
/// `towards_eye`. Exact: each of the frustum's sides is touched by a point, or an opposite pair is.
/// @pre points not empty; towards_eye != 0 and not parallel to view.up. Eye and target of `view` do not
/// matter.
View fit_view(std::span<const Vec3d> points, Vec3d towards_eye, View view);

/// Least distance from `centre`, along `towards_eye`, of an eye that looks at `centre` and sees all `points`.
/// @pre as fit_view().   @return > 0.
double fit_distance(std::span<const Vec3d> points, Vec3d centre, Vec3d towards_eye, const View& view);

/// "Front" as people model: +z where y is up, -y where z is up; perpendicular to `up`, unit.
Vec3d front_direction(Vec3d up);

/// A direction for a first picture: from the front, a little from the right and from above, in the frame of
/// `up`.
Vec3d three_quarter_direction(Vec3d up);

}  // namespace cuesta
