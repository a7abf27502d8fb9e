#pragma once
/// The exact vertical distance of triangles from all postings above and below them: what makes errors of a
/// terrain a guarantee (I5).

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "terrain/terrain_surface.h"

namespace cuesta {

/// Part of a lattice that holds every posting whose vertical goes through a triangle: a run of columns for
/// each row.
struct LatticeFootprint {
  std::int64_t first_row = 0;
  std::vector<std::array<std::int64_t, 2>>
      columns;  ///< first and last of each row; empty runs have last < first
};

class PostingMeasure {
 public:
  explicit PostingMeasure(const TerrainSurface& surface) : surface_(surface) {}

  /// As InputSurface::measure(). In the calling TBB arena; the same result for any number of threads.
  Result<void> measure(std::span<const std::array<Vec3i, 3>> triangles, std::span<float> distances) const;

 private:
  struct Run {  ///< of a triangle's footprint, in one square
    std::uint32_t triangle = 0;
    std::uint32_t row = 0, first = 0, last = 0;  ///< within the square
  };
  struct PlacedRun {
    std::uint64_t square = 0;
    Run run;
  };
  struct SquareRuns {
    std::uint64_t square = 0;
    std::vector<Run> runs;
  };
  LatticeFootprint footprint(std::uint32_t layer, const std::array<Vec3d, 3>& corners_m) const;
  std::array<std::int64_t, 2> columns_in_layer(std::uint32_t layer,
                                               std::array<std::int64_t, 2> columns) const;
  void add_runs(std::uint32_t triangle, std::uint32_t layer, const LatticeFootprint& footprint,
                std::vector<PlacedRun>& runs) const;
  std::vector<SquareRuns> runs_of(std::span<const std::array<Vec3i, 3>> triangles) const;
  Result<void> measure_square(const SquareRuns& square, std::span<const std::array<Vec3i, 3>> triangles,
                              std::span<float> distances) const;

  const TerrainSurface& surface_;
};

}  // namespace cuesta
