#pragma once
/// What the options of render, view and flight come to for a file that is terrain, and for one that is not.

#include "apps/cuesta/text_forms.h"
#include "apps/terrain_view/terrain_look.h"

namespace cuesta::app {

/// @error invalid_input: relief or exaggeration asked of a file that is no terrain; of terrain_look().
Result<std::optional<terrain_view::TerrainLook>> look_of(const Directory& directory,
                                                         const std::filesystem::path& path,
                                                         std::optional<Shading> shading, double exaggeration);

Shading shading_of(std::optional<Shading> given, const std::optional<terrain_view::TerrainLook>& look);

/// `view` at a camera; where it does not say its up, that of the terrain below the eye.
View camera_view(const CameraText& camera, View view, bool up_given,
                 const std::optional<terrain_view::TerrainLook>& look);

/// `view` with the up that a way around all of the file has.
View orbit_view(std::span<const Vec3d> points, View view, bool up_given,
                const std::optional<terrain_view::TerrainLook>& look);

}  // namespace cuesta::app
