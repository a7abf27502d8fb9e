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

/// An open scene file. One thread at a time.
class SceneSource {
 public:
  virtual ~SceneSource() = default;

  const Scene& scene() const { return scene_; }
  /// Names of the parts: as the file has them, neither clean nor looked through for equal ones.
  const std::vector<std::string>& parts() const { return parts_; }
  /// What the scene file has and this does not keep, each a sentence with a count: skins, morph targets,
  /// textures.
  const std::vector<std::string>& warnings() const { return warnings_; }
  /// Files that decide about the scene; the first is the one that was named, unless that is a folder.
  virtual std::vector<std::filesystem::path> files() const = 0;

  /// Streams one part into the sink, in the part's own frame, with vertex colours where the file has them or
  /// its triangles have different materials, without texture coordinates. The same vertices and triangles
  /// each time.
  /// @error as read_mesh()
  virtual Result<ReadReport> read_part(std::uint32_t part, MeshSink& sink) = 0;

 protected:
  Scene scene_;
  std::vector<std::string> parts_;
  std::vector<std::string> warnings_;
};

/// Opens a scene file, compressed or not, or a folder. Any other mesh file is a scene of one part.
/// @param memory_bytes  for its tables, and for what of a part can be read in one piece only (read_mesh())
/// @param temp  folder for what compressed files unpack to, as of read_mesh()
/// @error not_found, io, corrupt, unsupported_version, out_of_budget; invalid_input: nothing in it can be
/// shown
Result<std::unique_ptr<SceneSource>> open_scene(const std::filesystem::path& path, std::uint64_t memory_bytes,
                                                const std::filesystem::path& temp = {});

}  // namespace cuesta
