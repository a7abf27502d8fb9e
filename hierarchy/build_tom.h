#pragma once
/// From a mesh in memory to its TOM: greedy substitution, the cheapest legal one first.
/// Source: Bouvier, Gobbetti, "TOM: Totally Ordered Mesh", §4.1. Deviation: the error of each substitution is
/// measured with samples of the original (deviation.h), so the order comes with bounds.

#include <cstdint>

#include "hierarchy/tom.h"
#include "ooc/result.h"

namespace cuesta {

/// Which substitutions are legal. All keep seams of attributes closed and turn no triangle by more than 78°.
enum class TomOracle : std::uint8_t {
  manifold,  ///< those of edges that keep topology: a closed surface stays closed, at any resolution
  any_edge,  ///< the same; when none is left, those that change topology, and small components go as a whole
  pairs,     ///< TOM's: edges, and vertices at most pair_threshold apart, which joins components
};

/// What makes one substitution better than another.
enum class TomFairness : std::uint8_t {
  quadric,            ///< distance from the planes that the vertex stands for
  attribute_quadric,  ///< the same with normals, colours and texture coordinates as further dimensions
  memoryless,         ///< TOM's: change of volume, of area times length, of normals; nothing is remembered
};

struct TomOptions {
  TomOracle oracle = TomOracle::any_edge;
  TomFairness fairness = TomFairness::memoryless;
  double pair_threshold = 0;  ///< world units ≥ 0; for TomOracle::pairs
  double step = 0;            ///< positions become multiples of it, world units; 0 chooses (choose_grid.h)
  float attribute_weight =
      1;  ///< of attribute_quadric: what a change of 1 counts against 1 % of the diagonal
};

/// What was left out of the input.
struct TomReport {
  std::uint64_t bad_triangles = 0;         ///< a corner that is not finite
  std::uint64_t degenerate_triangles = 0;  ///< two corners at one place, after snapping
  std::uint64_t unused_vertices = 0;
  std::uint64_t welded_vertices = 0;  ///< equal to another in place and attributes
};

/// Builds the TOM of `mesh`. Pure: the same input and options give the same TOM; many parts can be built in
/// parallel. Deviations are measured by another thread of the calling TBB arena, if one is idle.
/// @pre   is_consistent(mesh)
/// @post  is_consistent(result); triangles are those of the input, but for what `report` counts.
/// @error invalid_input for a step that is negative, or so small that positions exceed 2^23 of it.
/// @cost  1 to 3 µs per triangle, O(n log n); 300 bytes per triangle for a while.
Result<Tom> build_tom(const SurfaceMesh& mesh, const TomOptions& options = {}, TomReport* report = nullptr);

}  // namespace cuesta
