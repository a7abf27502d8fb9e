#pragma once
/// The way in: meshes of any size and vertex order → clean chunks on disk, within a memory budget.
///
///   read        inputs → columns of vertices, triangles by the block of vertices they index   (RawSurface)
///   distribute  join block by block; triangles to the chunks that their centres lie in, and to those that
///               their corners lie in (TriangleSoup)
///   weld        if asked for: open borders near each other are joined (weld_borders) clean       chunk by
///   chunk; neighbours tell each other the numbers of vertices they share  (CleanChunk)
///
/// The result does not depend on threads, memory or interruptions: the journal knows what is done.

#include <cstdint>
#include <functional>
#include <memory>
#include <span>
#include <vector>

#include "ooc/build_progress.h"
#include "ooc/clean_chunk.h"
#include "ooc/input_surface.h"
#include "ooc/memory_budget.h"
#include "ooc/mesh_reader.h"
#include "ooc/raw_surface.h"
#include "ooc/work_folder.h"

namespace cuesta {

struct IngestOptions {
  /// Grid step in world units; 0 chooses 1/128 of the median edge, less if some edges are short, and at least
  /// 2^-21 of the largest extent.
  double step = 0;
  /// Compute smooth (area-weighted) normals where the inputs have none: not at all, or zero at a vertex.
  bool make_normals = true;
  /// Chunks have about this many triangles. Decides which vertices stay for the second round, and memory.
  std::uint32_t chunk_triangles = 1u << 18;
  /// Vertices that are joined with their triangles at one time; 0: what fits in 2/5 of the memory. Does not
  /// change the result.
  std::uint64_t block_vertices = 0;
  /// Points on open borders that are this near to each other, in world units, become one (weld_borders.h); 0:
  /// only those that are at one point of the grid.
  double weld_tolerance = 0;
};

/// A clean surface on disk.
class IngestedSurface : public InputSurface {
 public:
  std::vector<ReadReport> inputs;  ///< one per input
  MissingAttributes missing;
  CleanReport report;

  std::uint32_t chunk_count() const override { return static_cast<std::uint32_t>(chunks_.size()); }
  std::uint64_t triangles_of(std::uint32_t chunk) const override { return chunks_[chunk].triangles; }
  Result<SurfaceChunk> chunk(std::uint32_t c) const override;
  void prefetch(std::uint32_t c) const override;
  void discard(std::uint32_t c) const override;

 private:
  friend class Ingest;
  struct Part {
    std::uint64_t offset = 0, bytes = 0, checksum = 0;
  };
  struct Letter {
    std::uint32_t from = 0;
    Part part;
  };
  struct Chunk {
    Part part;
    std::uint64_t triangles = 0;
    std::vector<Letter> letters;
  };
  Result<void> read(const Part& part, std::span<std::byte> bytes) const;
  /// What other chunks tell chunk c, one entry per chunk that does, ascending.
  Result<std::vector<ChunkReplies>> replies_to(std::uint32_t c) const;

  std::unique_ptr<FileHandle> file_;
  std::vector<Chunk> chunks_;
};

/// Reads inputs into the sink that it is given. @return a report for each
using InputReader = std::function<Result<std::vector<ReadReport>>(RawSurface& sink)>;

/// Runs what of the stages is not in the work folder's journal, in parallel in the calling TBB arena.
/// @param read   not called when reading was finished by an earlier run
/// @error those of `read`; invalid_input when nothing is left, the grid step does not fit the extent, or the
/// weld
///        tolerance is not a number from 0 to kMostWeldPart of the extent;
///        out_of_budget for memory or disk; io; cancelled.
/// @cost about 1 µs per triangle and core; disk at the peak: 24 to 40 bytes per vertex, and per triangle 50
/// to 104 (20
///       and a soup record; 180 in place of the 20 where its corners are in several blocks).
Result<IngestedSurface> ingest(WorkFolder& folder, const IngestOptions& options, MemoryBudget& memory,
                               const InputReader& read, const BuildProgress& progress = {});

}  // namespace cuesta
