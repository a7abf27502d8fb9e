#pragma once
/// cuesta render of a scene: one picture, or a flight under a deadline.

#include "apps/cuesta/render_command.h"

namespace cuesta::app {

/// @error as run_render()
Result<void> run_scene_render(const RenderSettings& settings);

}  // namespace cuesta::app
