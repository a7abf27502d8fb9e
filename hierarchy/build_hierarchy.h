#pragma once
/// Builds a .cuesta file from a clean surface on disk, round by round, within a memory budget. DESIGN §2.

#include <cstdint>
#include <filesystem>
#include <string>

#include "hierarchy/cell_cache.h"
#include "hierarchy/page_codec.h"
#include "ooc/build_progress.h"
#include "ooc/input_surface.h"
#include "ooc/memory_budget.h"
#include "ooc/result.h"
#include "ooc/work_folder.h"

namespace cuesta {

struct BuildOptions {
  std::uint32_t cell_triangles = 1u << 15;  ///< largest cell; also the largest base page
  double round_reduction = 4;               ///< a cell is simplified to its triangles divided by this, > 1
  CellCache* cache = nullptr;               ///< outlives the build; changes no byte of the result
  std::string metadata = "{}";              ///< JSON object that is kept in the file
};

struct BuildReport {
  std::uint32_t rounds = 0;
  std::uint32_t pages = 0;
  std::uint64_t substitutions = 0;
  std::uint64_t fans = 0;
  std::uint64_t file_bytes = 0;
  PageStreamBytes stream_bytes{};
};

/// Builds and writes `path` from `surface`, in parallel over cells in the calling TBB arena. Same bytes for
/// any number of threads, any memory, and any number of interruptions: a task (round, chunk) that the
/// folder's journal knows is not done again.
/// @param surface  its chunks are discarded as they are used
/// @error invalid_input (more than 2^24 grid steps wide), out_of_budget (memory, disk), io, cancelled. Then
///        nothing is under `path`; the folder and `<path>.part` keep what is done.
/// @cost about 3 µs per triangle and core; disk: 30 bytes per triangle beside the file.
Result<BuildReport> build_hierarchy(const InputSurface& surface, const std::filesystem::path& path,
                                    const BuildOptions& options, WorkFolder& folder, MemoryBudget& memory,
                                    const BuildProgress& progress = {});

}  // namespace cuesta
