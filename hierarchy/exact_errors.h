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

/// Measures what each substitution of the page's script makes, and saturates again (I3). Where a border moves
/// or a component goes as a whole, postings may lie above nothing: there the estimate stays, if it is more.
/// @param births     of the page's triangles at the start of its round
/// @param survivors  of the script; their births get the new errors
/// @pre   surface.vertical has a value
/// @error those of InputSurface::measure()
Result<void> make_errors_exact(const InputSurface& surface, std::span<const Vec3i> positions,
                               std::span<const Birth> births, Page& page, CellSurvivors& survivors);

}  // namespace cuesta
