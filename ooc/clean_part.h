#pragma once
/// A part of a scene made ready for simplification, in memory.

#include "ooc/clean_report.h"
#include "ooc/grid.h"
#include "ooc/result.h"
#include "ooc/surface_mesh.h"

namespace cuesta {

struct CleanPart {
  SurfaceMesh mesh;  ///< positions lie on the grid, in world units
  Grid grid;
  CleanReport report;
  double snap_error = 0;  ///< how far the farthest used vertex was moved, world units
};

/// Snaps positions to a grid (choose_grid.h), drops faces that are not finite, degenerate or copies of
/// others, and gives vertices without normals those of their faces, broken at sharp edges (crease_normals.h).
/// May leave no triangle. Edges of more than two faces, and vertices where sheets meet, stay as they are.
/// @param step  of the grid, in world units; 0 chooses    @pre is_consistent(mesh)
/// @error invalid_input for a step that is too small for the extent
/// @cost O(n log n); 150 bytes per triangle meanwhile
Result<CleanPart> clean_part(SurfaceMesh mesh, double step, bool make_normals);

}  // namespace cuesta
