#pragma once
/// Parts of a scene that are simplified, in the work folder until the file can be laid out.

#include <cstdint>
#include <optional>
#include <vector>

#include "hierarchy/build_hierarchy.h"
#include "hierarchy/encode_part.h"
#include "hierarchy/scene_directory.h"
#include "ooc/file_handle.h"
#include "ooc/ingest.h"
#include "ooc/work_folder.h"

namespace cuesta {

struct StoredPart {
  ScenePartEntry entry;  ///< without name; offsets are those of the work file
  CleanReport clean;
};

struct SurfacePartOptions {
  IngestOptions ingest;
  BuildOptions build;
};

/// One thread at a time. What was added is there again when the folder is opened later.
class SceneParts {
 public:
  static Result<SceneParts> open(WorkFolder& folder);

  /// Appends the next TOM. @error out_of_budget (disk), io
  Result<void> add_tom(const EncodedPart& part);
  /// Builds the next surface in the calling TBB arena, or finds it built. @error of ingest(),
  /// build_hierarchy()
  Result<void> add_surface(const SurfacePartOptions& options, const InputReader& read, MemoryBudget& memory,
                           const BuildProgress& progress);

  std::uint64_t tom_count() const { return toms_.size(); }
  StoredPart tom(std::uint64_t i) const { return toms_[i]; }
  StoredPart surface(std::uint64_t i) const { return surfaces_[i]; }

  /// A block of an entry: of a TOM, or directory or base page of a surface. @error io; corrupt
  Result<std::vector<std::byte>> read(const BlockRef& block) const;
  /// The file that the i-th surface was built as.
  std::filesystem::path surface_path(std::uint64_t i) const;

 private:
  explicit SceneParts(WorkFolder& folder) : folder_(&folder) {}
  Result<BlockRef> append(std::span<const std::byte> bytes);
  Result<void> adopt(std::span<const std::byte> record);
  Result<StoredPart> store_surface(std::uint64_t i);

  WorkFolder* folder_;
  FileHandle file_;
  std::uint64_t end_ = 0;
  std::vector<StoredPart> toms_, surfaces_;
};

}  // namespace cuesta
