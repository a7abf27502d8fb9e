#pragma once
/// cuesta export of a scene.

#include "apps/cuesta/export_command.h"
#include "ooc/result.h"

namespace cuesta::app {

/// All instances at rest as one mesh, or those of some nodes, or one part in its own frame; colours of
/// materials at its vertices: in full, with an error in world
/// units that no instance exceeds, or with the least such error that so many triangles allow.
/// @error as SceneFile::open and SceneFile::read_segment; invalid_input for a camera, and
/// where nothing has the name; out_of_budget above
/// 2^32 vertices or triangles; those of write_mesh
Result<void> run_scene_export(const ExportSettings& settings);

}  // namespace cuesta::app
