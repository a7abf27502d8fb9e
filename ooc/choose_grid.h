#pragma once
/// The grid that a mesh is snapped to: fine against its edges, coarse enough for its extent.

#include <cstdint>
#include <span>

#include "ooc/grid.h"
#include "ooc/result.h"
#include "ooc/surface_mesh.h"
#include "ooc/triangle_order.h"

namespace cuesta {

inline constexpr double kStepsPerMedianEdge = 128;
inline constexpr double kStepsPerShortEdge = 8;        ///< of an edge that 99 % are longer than
inline constexpr double kMaxDefaultSteps = 1 << 21;    ///< the largest extent in steps, when the step is ours
inline constexpr double kMaxGridCoordinate = 1 << 30;  ///< exclusive
inline constexpr std::size_t kEdgeSampleTriangles = 1 << 16;

/// Origin at the box minimum of the triangles' vertices rounded down to a step, so that coordinates are in
/// [0, 2^30).
/// @param step  world units; 0 chooses max(min(median edge / 128, first percentile / 8), extent / 2^21), of
/// the edges, without
///              those of length 0, of at most 2^16 triangles at an even stride.
/// @pre   indices in range, positions finite.
/// @error invalid_input for a step that is not a positive number, or too small for the extent.
Result<Grid> choose_grid(std::span<const Vec3d> positions, std::span<const Triangle> triangles, double step);

}  // namespace cuesta
