#pragma once
/// A few thousand points that stand for a surface, and a camera that shows it all.

#include <filesystem>
#include <vector>

#include "apps/terrain_view/terrain_look.h"
#include "runtime/cut.h"

namespace cuesta::app {

/// A few thousand points of the surface, in world units, from the base page alone: to place cameras. Moves
/// the cut. Never empty.
std::vector<Vec3d> sketch_points(Cut& cut);

/// `view` from where a first picture shows all of the file: terrain from the south, anything else from its
/// front, a little from the right and above. Moves the cut.
/// @param look  of terrain.
View first_view(Cut& cut, const std::optional<terrain_view::TerrainLook>& look, const View& view);

}  // namespace cuesta::app
