#pragma once
/// cuesta build --type scene.

#include <filesystem>
#include <string>

#include "apps/cuesta/build_command.h"
#include "apps/cuesta/build_summary.h"
#include "apps/cuesta/progress.h"
#include "hierarchy/build_scene.h"
#include "ooc/work_folder.h"

namespace cuesta::app {

/// What an input is built as where --type does not say it: a scene, if it is one folder with mesh files and
/// no rasters, or one glTF file that shows several meshes, or one several times, or has animations.
/// @error of open_scene()
Result<bool> looks_like_scene(const BuildSettings& settings);

/// All files that decide about a scene. @error of open_scene()
Result<std::vector<std::filesystem::path>> files_of_scene(const BuildSettings& settings);

/// Builds it and notes what it is made of. @error of open_scene() and build_scene()
Result<void> build_scene_file(WorkFolder& folder, const BuildSettings& settings, BuildFacts& facts,
                              MemoryBudget& memory, Progress& progress);

/// JSON object for the file, as build_metadata() has for surfaces.
std::string scene_metadata(const SceneBuildReport& report, const BuildFacts& facts,
                           const BuildSettings& settings);
/// Lines for the screen between input and time.
std::string scene_rows(const SceneBuildReport& report);

}  // namespace cuesta::app
