#pragma once
/// A tile's content: binary glTF 2.0 with EXT_meshopt_compression and KHR_mesh_quantization.
///
/// Positions are u16 on the tileset's lattice, exact where the tile is less than 65,536 steps wide, else on
/// each second, fourth, … of its points; normals i8, octahedral in the compressed stream; colours u16
/// or u8, linear. The node's matrix brings them to metres, from z up to glTF's y up. No material has
/// textures; both sides are drawn, for scans have holes.

#include <cstddef>
#include <cstdint>
#include <vector>

#include "apps/tiles/tile_mesh.h"
#include "apps/tiles/tile_placement.h"

namespace cuesta::tiles {

struct TileGlb {
  std::vector<std::byte> bytes;
  double rounding = 0;  ///< how far positions may have been moved, in the file's units
};

/// How far encode_glb() moves positions.
double glb_rounding(const TileMesh& mesh, const TilePlacement& placement);

/// How exactly a content has colours: glTF wants linear ones, of which 8 bits are few in the dark and cost a
/// quarter of a content's bytes, 16 bits two thirds.
enum class GlbColours : std::uint8_t { none, u8, u16 };

/// @pre mesh has triangles and normals, and fewer than 2^32 vertices.   @cost 0.1 µs per triangle
TileGlb encode_glb(TileMesh mesh, const TilePlacement& placement, GlbColours colours);

}  // namespace cuesta::tiles
