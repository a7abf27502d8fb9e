#pragma once
/// An open .cuesta scene: its tables, and parts on demand. Its blocks are ordered so that a file that was cut
/// off, or is still being copied, is the scene with less detail: directory, then the coarsest segment of
/// every part, then the next of every part, and so on; pages of large parts last, coarse rounds first.

#include <filesystem>
#include <memory>
#include <span>
#include <vector>

#include "hierarchy/cuesta_file.h"
#include "hierarchy/scene_directory.h"
#include "ooc/container_file.h"

namespace cuesta {

class SceneFile {
 public:
  /// Reads and checks header and directory. A file that ends behind its directory is opened: see is_whole().
  /// @error not_found, io, corrupt, unsupported_version; invalid_input for a .cuesta file of a surface.
  static Result<SceneFile> open(const std::filesystem::path& path);
  /// @param source  shared with whoever delivers its bytes.
  static Result<SceneFile> open(std::shared_ptr<const ByteSource> source);

  std::span<const SceneNode> nodes() const { return directory_.scene.nodes; }
  std::span<const SceneMaterial> materials() const { return directory_.scene.materials; }
  std::span<const SceneClip> clips() const { return directory_.scene.clips; }
  std::span<const ScenePartEntry> parts() const { return directory_.parts; }
  std::span<const SceneInstance> instances() const { return instances_; }
  const SceneDirectory& directory() const { return directory_; }
  const std::filesystem::path& path() const { return container_->path(); }

  /// Bytes on disk, and those that the whole scene has.
  std::uint64_t file_bytes() const { return container_->file_bytes(); }
  std::uint64_t whole_bytes() const { return container_->whole_bytes(); }
  bool is_whole() const { return file_bytes() == whole_bytes(); }
  /// Segments of the part that are in the file: all of a whole one, else a number of the first ones.
  /// A surface counts as one when its directory and base page are there.
  std::uint32_t available_segments(std::uint32_t part) const;

  /// Bytes of one segment of a TOM, checked; tom_codec.h decodes them. Concurrent calls are safe.
  /// @pre part < parts().size() and segment < its segments. @error io; corrupt (place "part N, segment K"),
  /// also when a file that was cut off does not have it
  Result<std::vector<std::byte>> read_segment(std::uint32_t part, std::uint32_t segment) const;
  /// A large part as a surface of its own, for Cut::open() and whatever else reads surfaces. In a file that
  /// was cut off, pages that are missing cannot be read. Concurrent calls are safe. @cost its directory is
  /// decoded
  /// @pre part < parts().size() and it has a surface. @error io; corrupt, place "part N, …"
  Result<CuestaFile> open_surface(std::uint32_t part) const;

 private:
  static Result<SceneFile> open(Result<ContainerReader> container);
  SceneFile(std::shared_ptr<const ContainerReader> container, SceneDirectory directory);
  std::shared_ptr<const ContainerReader> container_;  ///< shared with the surfaces that were opened from it
  SceneDirectory directory_;
  std::vector<SceneInstance> instances_;
};

}  // namespace cuesta
