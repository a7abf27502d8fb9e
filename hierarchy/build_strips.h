#pragma once
/// From a totally ordered mesh to multiresolution strips.

#include <cstdint>
#include <span>

#include "hierarchy/strip_mesh.h"

namespace cuesta {

struct StripOptions {
  /// A band ends where so many times fewer vertices are active than where it begins. Infinity: one band, the
  /// paper's.
  double band_ratio = 2;
  /// Repetitions are cut out of the strips; else strips keep their length, and drawing skips repetitions: the
  /// paper's.
  bool dynamic_length = true;
};

/// Vertices are numbered so that those of resolution r are 0 to r - 1, as those of a Tom are: of one,
/// build_strips(tom.triangles, tom.substitute, tom.base_vertices).
/// @param triangles   the full mesh; a triangle with a vertex twice is left out.
/// @param substitute  of each vertex from base_resolution on, a vertex before it; of the others it is not
/// read.
/// @return at full resolution. At each resolution the strips have the triangles whose corners, replaced by
/// their first
///         active ancestors, are distinct, each as often as it comes, not turned over.
/// @pre 1 ≤ base_resolution ≤ substitute.size(); at most 2^26 triangles.
/// @cost about 1.5 µs per triangle; 100 bytes per triangle for a while.
StripMesh build_strips(std::span<const Triangle> triangles, std::span<const std::uint32_t> substitute,
                       std::uint32_t base_resolution, const StripOptions& options = {});

}  // namespace cuesta
