#pragma once
/// The files of an export, one at a time and by name, for those who do not want to wait for all of them.
/// Every file has the bytes that export_tiles() and export_terrain() write.

#include <cstddef>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "apps/tiles/terrain_pyramid.h"
#include "apps/tiles/tile_producer.h"

namespace cuesta::tiles {

struct TileFile {
  std::string name;
  std::vector<std::byte> bytes;
};

/// Threads: one at a time.
class TileSource {
 public:
  virtual ~TileSource() = default;
  /// The file of that name, first, and others that were made on the way to it and are asked for next: with a
  /// tileset the contents of its children.
  /// @error not_found: an export has no such file; of reading pages, after which the source reads no more;
  ///   out_of_budget: a tile does not fit the page cache.
  virtual Result<std::vector<TileFile>> make(const std::string& name) = 0;
};

/// tileset.json, t….json, t….glb.   @param known, @error  as TileProducer::open
Result<std::unique_ptr<TileSource>> open_tile_source(const std::filesystem::path& file,
                                                     const TileOptions& options,
                                                     std::shared_ptr<KnownTiles> known);
/// layer.json, z/x/y.terrain.   @error as TerrainPyramid::open
Result<std::unique_ptr<TileSource>> open_terrain_source(const std::filesystem::path& file,
                                                        const TerrainOptions& options);

/// "tileset.json" of the root, else Tile::id() + ".json".
std::string tileset_name(const Tile& tile);
/// tileset_json() with the root's transform where it belongs.
std::string tileset_file(const TileProducer& producer, const TileFacts& tile,
                         std::span<const TileFacts> children);

}  // namespace cuesta::tiles
