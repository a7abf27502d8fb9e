#pragma once
/// Behind scene_source.h: the scene's file, unpacked if it was compressed, and one class per format.

#include <filesystem>
#include <memory>

#include "ooc/map_window.h"
#include "ooc/mapped_file.h"
#include "ooc/read_job.h"
#include "ooc/scene_source.h"

namespace cuesta {

/// A file to read from again and again.
struct SceneInput {
  std::filesystem::path path;   ///< as the user gave it
  std::filesystem::path inner;  ///< its name unpacked
  std::filesystem::path temp;
  MappedFile file;

  /// @error of MappedFile::open() and unpack_file()
  static Result<SceneInput> open(const std::filesystem::path& path, std::uint64_t memory_bytes,
                                 const std::filesystem::path& temp);
  /// @error io: the file was changed since it was opened
  Result<void> check_unchanged() const;
};

/// For readers of tables alone: takes nothing.
class NoSink : public MeshSink {
 public:
  Result<void> vertices(const VertexBlock&) override { return {}; }
  Result<void> triangles(TriangleBlock) override { return {}; }
};

// One per format; the caller has recognised the format.
Result<std::unique_ptr<SceneSource>> open_gltf_scene(SceneInput input, std::uint64_t memory_bytes);
Result<std::unique_ptr<SceneSource>> open_obj_scene(SceneInput input, std::uint64_t memory_bytes);
/// A folder, or a file of one part. Names that no mesh file has are passed over.
Result<std::unique_ptr<SceneSource>> open_mesh_files(const std::filesystem::path& path,
                                                     std::uint64_t memory_bytes,
                                                     const std::filesystem::path& temp);

}  // namespace cuesta
