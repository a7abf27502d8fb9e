#pragma once
/// Cameras that show a whole box: for a first picture, and for flights around a model.

#include "runtime/view.h"

namespace cuesta {

/// Least distance from the box's centre, along the direction `towards_eye`, at which the whole box is in the
/// picture.
/// @pre the box is not empty; towards_eye != 0 and not parallel to view.up. Eye and target of `view` do not
/// matter.
double fit_distance(const Box3d& box, Vec3d towards_eye, const View& view);

/// `view` with eye and target such that the box fills the picture but for a margin, seen from `towards_eye`.
View fit_view(const Box3d& box, Vec3d towards_eye, View view);

/// "Front" as people model: +z where y is up, -y where z is up; perpendicular to `up`, unit.
Vec3d front_direction(Vec3d up);

/// A direction for a first picture: from the front, a little from the right and from above, in the frame of
/// `up`.
Vec3d three_quarter_direction(Vec3d up);

}  // namespace cuesta
