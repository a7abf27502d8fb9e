#pragma once
/// One tile of terrain as quantized-mesh 1.0, with normals ("octvertexnormals").
/// Source: "quantized-mesh-1.0 terrain format", Cesium; ellipsoid WGS 84.

#include <array>
#include <cstddef>
#include <vector>

#include "ooc/vec.h"
#include "terrain/terrain_metadata.h"

namespace cuesta::tiles {

/// A vertex on the tile's own lattice: u east and v north, 0 to 32767, both borders included.
struct TerrainVertex {
  std::int32_t u = 0, v = 0;
  double h_m = 0;
  Vec3f normal;  ///< ECEF, unit
};

struct TerrainTileMesh {
  GeoBox box;
  std::vector<TerrainVertex> vertices;
  std::vector<std::array<std::uint32_t, 3>> triangles;  ///< counter-clockwise from above
};

inline constexpr std::int32_t terrain_steps = 32767;

/// Heights are stored in steps of (most - least) / 32767, of the tile's own heights.
/// @pre there are triangles.   @cost O(n)
std::vector<std::byte> encode_quantized_mesh(const TerrainTileMesh& tile);

}  // namespace cuesta::tiles
