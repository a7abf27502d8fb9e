#pragma once
/// cuesta export --format 3dtiles and quantized-mesh: a .cuesta file as tiles.

#include <filesystem>

#include "apps/tiles/tile_producer.h"

namespace cuesta::app {

struct TilesSettings {
  std::filesystem::path file, output;  ///< a folder, or a .3tz archive
  tiles::TileOptions options;          ///< cache_bytes 0: half of the machine's memory
  bool terrain = false;                ///< quantized-mesh
  double finest_error_m = 0;           ///< of it
  bool json = false, quiet = false;
};

/// Prints tiles, triangles, bytes and the root's error.
/// @error of reading, of writing; out_of_budget if a tile does not fit the cache; cancelled.
Result<void> run_export_tiles(const TilesSettings& settings);

}  // namespace cuesta::app
