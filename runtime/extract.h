#pragma once
/// The cut as a mesh of its own: what is drawn, taken out of the pools.

#include "ooc/result.h"
#include "ooc/surface_mesh.h"
#include "runtime/draw_list.h"

namespace cuesta {

struct ExtractOptions {
  bool normals = true;
  bool colours = true;
};

/// Drawn triangles with the vertices they use, numbered by first use; positions in world f64, exact up to the
/// rounding of origin + step · grid. Texture coordinates come out when the list has them.
/// @error out_of_budget above 2^32 - 2 vertices.
/// @cost O(vertex slots + drawn triangles); 4 bytes per slot beyond the result.
Result<SurfaceMesh> extract_mesh(const DrawList& list, const ExtractOptions& options = {});

}  // namespace cuesta
