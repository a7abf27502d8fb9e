#pragma once
/// Uniform and view-dependent cuts of a surface, held to I1, I2's topology, and I5.

#include <cstdint>

#include "hierarchy/verify_file.h"

namespace cuesta::verify {

struct SampleOptions {
  /// Larger surfaces are not sampled: the full one is held in memory (about 250 bytes per triangle).
  std::uint64_t max_triangles = 8'000'000;
};

/// Where `report` counts substitutions that let topology go, cuts are only held to having no cracks.
/// Adds to `report`: violations, the number of cuts, the median ratio of bound to measured distance, or why
/// cuts were left out. Uniform: each original vertex is within the reported error of the cut. View-dependent:
/// the same in pixels as seen from the eye. Parallel in the calling TBB arena.
/// @param file  a file of its own, or a large part of a scene
/// @error cancelled.   @cost about 10 µs per triangle.
Result<void> verify_cuts(const CuestaFile& file, const SampleOptions& options, VerifyReport& report,
                         const VerifyProgress& progress = {});

}  // namespace cuesta::verify
