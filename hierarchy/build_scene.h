#pragma once
/// Builds a .cuesta scene: every distinct part once, small ones as TOMs, large ones as surfaces.

#include <cstdint>
#include <filesystem>
#include <functional>
#include <string>

#include "hierarchy/build_hierarchy.h"
#include "ooc/clean_report.h"
#include "ooc/mesh_reader.h"
#include "ooc/scene_source.h"

namespace cuesta {

/// What was read, and what became of it.
struct SceneBuildReport {
  std::uint64_t nodes = 0, instances = 0, materials = 0, clips = 0;
  std::uint64_t parts_read = 0;   ///< that a node shows
  std::uint64_t parts_equal = 0;  ///< of them: equal to one before, and stored as that one
  std::uint64_t parts_empty = 0;  ///< of them: without triangles, or nothing was left after cleaning
  std::uint64_t toms = 0, surfaces = 0;
  std::uint64_t vertices = 0, triangles = 0;  ///< of all parts stored
  std::uint64_t instanced_triangles = 0;      ///< of all instances
  std::uint64_t instanced_read = 0;           ///< as the file has them: before cleaning
  ReadReport read;                            ///< of the distinct parts
  CleanReport clean;                          ///< of these
  std::uint64_t coarsest_bytes = 0;           ///< of the file until every part has its coarsest segment
  std::uint64_t file_bytes = 0;
};

struct SceneBuildOptions {
  std::uint64_t largest_tom = std::uint64_t{1} << 17;  ///< parts of more triangles become surfaces
  double step = 0;                          ///< grid step of every part, in its own units; 0 chooses for each
  bool make_normals = true;                 ///< of vertices that have none
  std::uint32_t cell_triangles = 1u << 15;  ///< of surfaces
  /// The JSON object that is kept in the file.
  std::function<std::string(const SceneBuildReport&)> metadata = [](const SceneBuildReport&) { return "{}"; };
};

/// Builds and writes `path`, parts in parallel in the calling TBB arena. Same bytes for any number of
/// threads, any memory, and any number of interruptions: a part that the folder's journal knows is not
/// simplified again.
/// @param source  read by one thread at a time
/// @error of the source; invalid_input: no part has a triangle, or a grid step does not fit; out_of_budget
///        (memory, disk), io, cancelled. Then nothing is under `path`.
/// @cost  two passes over the source; 3 µs per triangle of a distinct part and core; disk: the file's size
/// once
///        more, and what build_hierarchy() needs for one surface at a time
Result<SceneBuildReport> build_scene(SceneSource& source, const std::filesystem::path& path,
                                     const SceneBuildOptions& options, WorkFolder& folder,
                                     MemoryBudget& memory, const BuildProgress& progress = {});

}  // namespace cuesta
