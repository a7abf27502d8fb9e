#pragma once
/// What the vertex shader needs of a View to place grid positions without jitter in worlds of 2^30 grid
/// units.

#include <array>

#include "ooc/grid.h"
#include "runtime/view.h"

namespace cuesta {

/// Lengths are in grid units. camera = rotation · ((position - eye_whole) - eye_part), where the integer
/// subtraction is exact, so that the rounding of what follows is relative to the distance from the eye: an
/// error of at most 2^-22 of the distance, or 0.001 pixels. Depth is `near / distance` (reversed, no far
/// plane): with 32-bit floats it resolves about 10^-7 of the distance everywhere.
struct CameraMatrices {
  Vec3i eye_whole;                ///< within ±(2^30 - 1): position - eye_whole cannot overflow
  Vec3f eye_part;                 ///< the rest; in 0…1 unless the eye is outside the grid
  std::array<float, 9> rotation;  ///< rows: right, up, back
  std::array<float, 2> focal;     ///< clip x and y per unit of x / distance and y / distance
  float near_units;               ///< distance of the near plane: nothing nearer is drawn
};

/// @pre   view is valid and grid.step > 0.
CameraMatrices camera_matrices(const View& view, const Grid& grid);

}  // namespace cuesta
