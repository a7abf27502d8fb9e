#pragma once
/// Where a ray meets what is drawn: for the pointer, and for the ground below someone who walks.

#include <optional>
#include <span>

#include "hierarchy/directory.h"
#include "runtime/draw_list.h"
#include "runtime/relief.h"

namespace cuesta::view {

/// Distance in world units from `origin` to the nearest drawn triangle on a ray, from either side.
/// Where the list tells the pages, those whose bound the ray misses are passed by.
/// @param direction  unit, world frame.
/// @param relief     how heights are drawn exaggerated, if they are.
/// @cost  O(triangles drawn of the pages that the ray may meet before the nearest triangle).
std::optional<double> distance_along(const DrawList& list, const Directory& directory, Vec3d origin,
                                     Vec3d direction, const std::optional<Relief>& relief = {});

}  // namespace cuesta::view
