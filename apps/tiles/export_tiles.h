#pragma once
/// All tiles of a file, of either kind, one after the other, into a folder or an archive.

#include <functional>

#include "apps/tiles/terrain_pyramid.h"
#include "apps/tiles/tile_files.h"
#include "apps/tiles/tile_producer.h"

namespace cuesta::tiles {

struct TilesReport {
  std::uint64_t tiles = 0, leaves = 0, tilesets = 0;
  std::uint64_t triangles = 0;  ///< of all tiles
  std::uint64_t bytes = 0;
  std::uint64_t levels = 0;
  double root_error = 0;  ///< its geometric error
};

/// Called after each tile.   @return an error to stop with.
using TileProgress = std::function<Result<void>(const TilesReport&)>;

/// Writes tileset.json, a tileset for each tile that has children, and contents, as tileset_json() names
/// them. Memory: the producer's cache and its knowledge of tiles, a tile, and some kilobytes for each level.
/// @error of the producer, of `files`, of `progress`; invalid_input: no triangles.
Result<TilesReport> export_tiles(TileProducer& producer, TileFiles& files, const TileProgress& progress);

/// Writes layer.json and z/x/y.terrain.   @error of the pyramid, of `files`, of `progress`.
Result<TilesReport> export_terrain(TerrainPyramid& pyramid, TileFiles& files, const TileProgress& progress);

}  // namespace cuesta::tiles
