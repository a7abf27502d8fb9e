#pragma once
/// What a tile of terrain has where there is none: clients take a tile for all of its rectangle.

#include "apps/tiles/quantized_mesh.h"

namespace cuesta::tiles {

/// Adds triangles between the mesh and the tile's corners, which are at `h_m` where the mesh does not reach
/// them. All of the tile where the mesh is empty. Nothing is moved, so neighbours that agreed on a border do
/// so still.
/// @param up  of the corners.   @cost O(n log n) of the mesh's borders.
void fill_around(TerrainTileMesh& tile, double h_m, Vec3f up);

}  // namespace cuesta::tiles
