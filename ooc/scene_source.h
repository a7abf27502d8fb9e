#pragma once
/// Scene files in: glTF and GLB (Draco, meshopt, EXT_mesh_gpu_instancing, animations), OBJ with groups and
/// materials, and folders of mesh files. Tables are read at once, the geometry of parts one part at a time.

#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "ooc/mesh_reader.h"
#include "ooc/result.h"
#include "ooc/scene.h"

namespace cuesta {

/// A part as its file has it: neither is it clean, nor has it been looked for equal ones.
struct ScenePart {
  std::string name;
};

/// An open scene file. One thread at a time.
class SceneSource {
 public:
  virtual ~SceneSource() = default;

  const Scene& scene() const { return scene_; }
  const std::vector<ScenePart>& parts() const { return parts_; }
  /// What the scene file has and this does not keep, each a sentence with a count: skins, morph targets,
  /// points and lines, textures.
  const std::vector<std::string>& warnings() const { return warnings_; }
  /// Files that were read, the one that was named first.
  const std::vector<std::filesystem::path>& files() const { return files_; }

  /// Streams one part into the sink, in the part's own frame, with vertex colours where its triangles have
  /// different materials. The same blocks each time.
  /// @param memory_bytes  for what can be read in one piece only, as of read_mesh()
  /// @error as read_mesh()
  virtual Result<ReadReport> read_part(std::uint32_t part, MeshSink& sink, std::uint64_t memory_bytes) = 0;

 protected:
  Scene scene_;
  std::vector<ScenePart> parts_;
  std::vector<std::string> warnings_;
  std::vector<std::filesystem::path> files_;
};

/// Opens a scene file, compressed or not, or a folder.
/// @param memory_bytes  for its tables
/// @param temp  folder for what compressed files unpack to, as of read_mesh()
/// @error not_found, io, corrupt, unsupported_version, out_of_budget; invalid_input: nothing in it can be
/// shown
Result<std::unique_ptr<SceneSource>> open_scene(const std::filesystem::path& path, std::uint64_t memory_bytes,
                                                const ReadProgress& progress = {},
                                                const std::filesystem::path& temp = {});

}  // namespace cuesta
