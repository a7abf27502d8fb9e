#pragma once
/// cuesta verify of a scene.

#include "apps/cuesta/verify_command.h"
#include "ooc/result.h"

namespace cuesta::app {

/// Decodes every part and holds it to the scene's directory; large parts, which are surfaces, to what
/// verify_file() checks, and, unless it shall be quick, sample cuts of them to what verify_cuts() does.
/// @error as SceneFile::open; corrupt when something was found; cancelled.
Result<void> run_scene_verify(const VerifySettings& settings);

}  // namespace cuesta::app
