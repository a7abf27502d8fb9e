#pragma once
/// A second opinion on topology, behind a header that does not include OpenMesh.

#include <string>

#include "tests/ooc/grid_mesh.h"

namespace cuesta::test {

/// Gives the mesh to OpenMesh, one vertex per wedge group.
/// @return "" or which face it refuses, or which vertex it finds not manifold.
std::string openmesh_complaint(const GridMesh& mesh);

}  // namespace cuesta::test
