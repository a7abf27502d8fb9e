#pragma once
/// What must be known of a surface before its triangles are sorted into chunks: its grid, and where it is
/// dense.

#include <cstdint>
#include <vector>

#include "ooc/grid.h"
#include "ooc/raw_surface.h"

namespace cuesta {

struct Survey {
  Grid grid;
  std::vector<Vec3f> samples;  ///< some of its vertices, grid units; at most 2^20
  std::uint64_t nonfinite_vertices = 0;
  std::uint64_t unused_vertices = 0;
  std::uint64_t used_vertices = 0;
};

/// Looks at all vertices that triangles use, in parallel. Vertices are sampled by their numbers.
/// @pre raw.finish() was called.   @error those of choose_grid() and of reading
Result<Survey> survey(const RawSurface& raw, double step);

}  // namespace cuesta
