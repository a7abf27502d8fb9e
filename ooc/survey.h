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
  Box3<std::int32_t> box;      ///< of the vertices that are used, grid units; empty if none is
  std::vector<Vec3f> samples;  ///< of the vertices that are used 2^20 at most, give or take; grid units
  std::uint64_t nonfinite_vertices = 0;
  std::uint64_t unused_vertices = 0;  ///< finite; of more than 2^29 vertices too few (RawSurface::is_used)
  std::uint64_t used_vertices = 0;    ///< the others
};

/// Looks at all vertices, in parallel. Those that are sampled are chosen by a hash of their numbers.
/// @param step  for choose_grid().   @pre raw.finish() was called.
/// @error those of choose_grid() and of reading.   @cost 6 MiB for each of twice the threads, not reserved
Result<Survey> survey(const RawSurface& raw, double step);

}  // namespace cuesta
