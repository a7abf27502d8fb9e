#pragma once
/// The grid that a mesh is snapped to: fine against its edges, coarse enough for its extent.

#include <cstdint>
#include <vector>

#include "ooc/grid.h"
#include "ooc/result.h"

namespace cuesta {

inline constexpr double kStepsPerMedianEdge = 128;
inline constexpr double kStepsPerShortEdge = 8;        ///< of an edge that 99 % are longer than
inline constexpr double kMaxDefaultSteps = 1 << 21;    ///< the largest extent in steps, when the step is ours
inline constexpr double kMaxGridCoordinate = 1 << 30;  ///< exclusive
inline constexpr std::size_t kEdgeSampleTriangles = 1 << 16;

/// Origin at the box minimum rounded down to a step, so that coordinates are in [0, 2^30).
/// @param box    of the vertices that triangles use; may be empty
/// @param edge_lengths  of a sample of triangles (consumed); zeros are left out
/// @param step  world units; 0 chooses max(min(median edge / 128, first percentile / 8), extent / 2^21).
/// @error invalid_input for a step that is not a positive number, or too small for the extent.
Result<Grid> choose_grid(const Box3d& box, std::vector<double> edge_lengths, double step);

}  // namespace cuesta
