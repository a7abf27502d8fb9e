#pragma once
/// The geometry of a LiveScene out of a .cuesta scene.

#include "hierarchy/scene_file.h"
#include "runtime/live_scene.h"

namespace cuesta {

/// @param file  outlives the sources, and the scene that is opened with them
/// @param clock, load_threads  of the cuts of large parts
SceneSources sources_of(const SceneFile& file, Clock clock, std::uint32_t load_threads);

}  // namespace cuesta
