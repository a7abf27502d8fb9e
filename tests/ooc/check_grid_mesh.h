#pragma once
/// Tells whether a GridMesh is what grid_mesh.h promises. Shares no code with what makes one.

#include <string>

#include "tests/ooc/grid_mesh.h"

namespace cuesta::test {

/// @return "" or a sentence that names the first invariant found violated, with its indices: sizes and
/// ranges, grid,
///         wedge groups, unused vertices, faces, edges, fans, order of triangles. The space-filling curve is
///         not checked: any curve is as good.
/// @cost   O(n log n), about 150 bytes per triangle. Never fails, whatever the mesh holds.
std::string find_violation(const GridMesh& mesh);

}  // namespace cuesta::test
