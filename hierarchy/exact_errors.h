#pragma once
/// Errors of a field of heights over every posting, for a script whose errors are estimates because its cell
/// knew a choice of them (max_triangle_samples).

#include <span>
#include <vector>

#include "hierarchy/cell_mesh.h"
#include "hierarchy/page.h"
#include "ooc/input_surface.h"
#include "ooc/result.h"

namespace cuesta {

/// Measures what each substitution of the page's script makes, and saturates again (I3). Where the rim moves
/// or a component goes as a whole, the postings that lie above and below nothing afterwards are measured
/// beside it (RimPostings).
/// @param cell       as it was at the start of its round
/// @param survivors  of the script; their births get the new errors, and all postings beside them become
/// their samples
/// @pre   surface.vertical and cell.vertical have a value
/// @error those of InputSurface::measure()
Result<void> make_errors_exact(const InputSurface& surface, const CellMesh& cell, Page& page,
                               CellSurvivors& survivors);

}  // namespace cuesta
