#pragma once
/// The exact vertical distance of triangles from all postings above and below them: what makes errors of a
/// terrain a guarantee (I5).

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "terrain/lattice_footprint.h"
#include "terrain/terrain_surface.h"

namespace cuesta {

class PostingMeasure {
 public:
  explicit PostingMeasure(const TerrainSurface& surface);

  /// As InputSurface::measure(). In the calling TBB arena; the same result for any number of threads.
  Result<void> measure(std::span<const std::array<Vec3i, 3>> triangles, std::span<float> distances) const;
  /// As InputSurface::postings_over().
  Result<std::vector<std::optional<std::vector<Vec3i>>>> postings_over(
      std::span<const std::array<Vec3i, 3>> triangles, std::size_t most) const;

 private:
  struct Run {  // of a triangle's footprint, in one square
    std::uint32_t triangle = 0;
    std::uint32_t row = 0, first = 0, last = 0;  // within the square
  };
  struct SquareRuns {
    std::uint64_t square = 0;
    std::vector<Run> runs;
  };
  struct Placed {
    std::uint64_t square = 0;
    Run run;
  };
  void place(std::uint32_t triangle, std::uint32_t layer, const LatticeRun& run,
             std::vector<Placed>& out) const;
  /// What a triangle's footprint is made of, at most.
  struct Extent {
    std::uint64_t postings = 0, runs = 0;
  };
  template <class Visit>
  void visit_footprint(const std::array<Vec3i, 3>& triangle, const Visit& visit) const;
  std::vector<Extent> extents_of(std::span<const std::array<Vec3i, 3>> triangles) const;
  /// Of some of the triangles, by their numbers.
  std::vector<SquareRuns> runs_of(std::span<const std::array<Vec3i, 3>> triangles,
                                  std::span<const std::uint32_t> some) const;
  /// visit(triangle, posting, distance) for all postings over the triangles in a square.
  template <class Visit>
  Result<void> visit_square(const SquareRuns& square, std::span<const std::array<Vec3i, 3>> triangles,
                            const Visit& visit) const;

  const TerrainSurface& surface_;
  std::vector<LatticeFootprints> footprints_;  // by layer
};

}  // namespace cuesta
