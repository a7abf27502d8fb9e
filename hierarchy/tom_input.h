#pragma once
/// What a TOM is built from: the mesh on its grid, cleaned, welded and in spatial order.

#include <cstdint>
#include <vector>

#include "hierarchy/build_tom.h"
#include "hierarchy/cell_mesh.h"
#include "ooc/grid.h"
#include "ooc/result.h"

namespace cuesta {

/// Vertices at one place are one point of the surface; those with different attributes are its wedges.
struct TomInput {
  Grid grid;
  CellMesh cell;
  std::vector<std::uint32_t> source;        ///< per vertex of the cell, one of the mesh that it is
  std::vector<std::uint32_t> first_vertex;  ///< per point, and the end
};

/// @error invalid_input: that of choose_grid(), or more than 2^23 steps.
Result<TomInput> tom_input(const SurfaceMesh& mesh, double step, TomReport& report);

}  // namespace cuesta
