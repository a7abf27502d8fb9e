#pragma once
/// A mosaic as a surface to build from: postings become vertices in a frame, cells of the lattice two
/// triangles each. Chunks are squares of lattice, made when they are asked for.

#include <cstdint>
#include <memory>
#include <vector>

#include "ooc/build_progress.h"
#include "ooc/input_surface.h"
#include "ooc/memory_budget.h"
#include "ooc/work_folder.h"
#include "terrain/frame.h"
#include "terrain/image_drape.h"
#include "terrain/mosaic.h"
#include "terrain/posting_positions.h"
#include "terrain/posting_store.h"
#include "terrain/seam_fans.h"

namespace cuesta {

struct TerrainOptions {
  /// Grid step in metres; 0: what keeps heights to half of their own steps (to itself in a plane whose
  /// postings lie on whole steps) and goes at least 8 times into the spacing, for heights that are not in
  /// steps 1/256 of the spacing and at most 0.5 m, as a power of 2, and what the extent allows.
  double step_m = 0;
  std::uint32_t square_side = 384;  ///< of a chunk, postings: 9 cells of 2^15 triangles
  bool make_normals = true;
  const ImageDrape* drape = nullptr;  ///< gives colours; outlives the surface
};

/// What the survey found.
struct TerrainFigures {
  MosaicCounts postings;
  double least_m = 0, most_m = 0;  ///< heights
  double spacing_m = 0;            ///< of the finest layer's rows, in its middle
};

/// Heights are taken as f32. Error bounds of what is built from it are vertical, over every posting; where a
/// rim or the edge of a void has moved, the distance to it.
class TerrainSurface final : public InputSurface {
 public:
  /// Reads the whole mosaic once, into the work folder; an earlier run's journal spares that.
  /// @param mosaic  outlives the surface
  /// @error of Mosaic::read(); invalid_input: no triangle, or a step too small for the extent; out_of_budget;
  /// cancelled.
  /// @cost  4 bytes of disk and about 0.2 µs a posting, in the calling TBB arena.
  static Result<std::unique_ptr<TerrainSurface>> survey(const Mosaic& mosaic, const Frame& frame,
                                                        const TerrainOptions& options, WorkFolder& folder,
                                                        MemoryBudget& memory,
                                                        const BuildProgress& progress = {});

  const TerrainFigures& figures() const { return figures_; }

  std::uint32_t chunk_count() const override { return store_.chunk_count(); }
  std::uint64_t triangles_of(std::uint32_t chunk) const override { return chunk_triangles_[chunk]; }
  Result<SurfaceChunk> chunk(std::uint32_t c) const override;
  Result<void> measure(std::span<const std::array<Vec3i, 3>> corners,
                       std::span<float> distances) const override;
  Result<std::vector<std::optional<std::vector<Vec3i>>>> postings_over(
      std::span<const std::array<Vec3i, 3>> corners, std::size_t most) const override;

 private:
  friend class TerrainSurvey;
  friend class TerrainChunk;
  friend class PostingMeasure;
  TerrainSurface(const Mosaic& mosaic, const Frame& frame, const TerrainOptions& options, PostingStore store);

  /// The posting that stands for one: where a layer closes on itself columns go around, and at a pole the
  /// cells that edges join have one, that of the first of them. @param column  at a pole, that of a cell
  PostingRef place(std::uint32_t layer, std::int64_t column, std::int64_t row) const;
  VertexId id_of(const PostingRef& at, std::uint32_t fan) const;
  /// Corner 0 of these seams lies in the chunk's square.
  std::span<const SeamTriangle> seams_of(std::uint32_t chunk) const;
  std::uint32_t seam_vertex_fan(const SeamTriangle& seam, std::size_t corner) const {
    return seam_fans_.of_seam(static_cast<std::size_t>(&seam - seams_.data()), corner);
  }
  /// Which rows of a patch that begins with this row are at poles.
  PoleRows pole_rows(std::uint32_t layer, std::int64_t first_row) const;
  bool is_pole(std::uint32_t layer, std::uint64_t row) const;
  /// Whether a vertex at a pole has this posting.
  bool is_pole_vertex(const PostingRef& at) const;
  /// Which cells at the poles begin a fan. @cost of reading two rows a pole
  Result<void> find_pole_fans();
  Result<std::vector<std::uint64_t>> pole_fans(std::uint32_t layer, std::uint64_t pole_row) const;

  /// Which postings of seams are several vertices. @cost about 15 µs a posting and core
  Result<void> find_seam_fans();
  Result<CellFans> cell_fans(const PostingRef& at) const;

  /// Columns of cells that begin a fan, rising.
  struct PoleFans {
    std::vector<std::uint64_t> north, south;
  };
  const std::vector<std::uint64_t>& pole_fans_at(const PostingRef& at) const {
    return at.row == 0 && layers_[at.layer].north_pole ? pole_fans_[at.layer].north
                                                       : pole_fans_[at.layer].south;
  }

  const std::vector<MosaicLayer>& layers_;
  Frame frame_;
  TerrainOptions options_;
  PostingStore store_;
  std::vector<PostingPositions> positions_;  // by layer
  std::vector<PoleFans> pole_fans_;          // by layer
  std::vector<std::uint64_t> chunk_triangles_;
  std::vector<SeamTriangle> seams_;          // by square of their corner 0
  std::vector<std::uint64_t> seam_squares_;  // of each
  SeamFans seam_fans_;
  TerrainFigures figures_;
};

}  // namespace cuesta
