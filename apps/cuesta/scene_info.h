#pragma once
/// cuesta info of a scene.

#include "apps/cuesta/info_command.h"
#include "ooc/result.h"

namespace cuesta::app {

/// @error as SceneFile::open.
Result<void> run_scene_info(const InfoSettings& settings);

}  // namespace cuesta::app
