#pragma once
/// Lays a scene out in its file.

#include <cstdint>
#include <filesystem>

#include "hierarchy/scene_directory.h"
#include "hierarchy/scene_parts.h"

namespace cuesta {

struct SceneWritten {
  std::uint64_t coarsest_bytes = 0;  ///< of the file until every part has its coarsest segment
  std::uint64_t file_bytes = 0;
};

/// Writes directory, blocks and pages of surfaces in the order of lay_out(), under a temporary name until all
/// is there.
/// @param directory  offsets are those of `parts`' work file; the n-th surface in it is parts' n-th
/// @error io, out_of_budget (disk)
Result<SceneWritten> write_scene(const std::filesystem::path& path, const SceneDirectory& directory,
                                 const SceneParts& parts);

}  // namespace cuesta
