#pragma once
/// A terrain as tiles of quantized-mesh in the scheme of CesiumJS: EPSG:4326, two tiles at level 0, y from
/// the south (TMS).
///
/// Level z has an error of 9,634 m / 2^z, an eighth of what CesiumJS takes it to have; the last level, where
/// a tile is some 128 postings wide, has `finest_error`. Neighbours of one level have the same vertices on
/// the border between them; between levels clients put skirts. Where a tile has no data it is filled to
/// height 0. Threads: one at a time.

#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "apps/tiles/quantized_mesh.h"
#include "apps/tiles/tile_cut.h"
#include "apps/tiles/tile_placement.h"

namespace cuesta::tiles {

struct TerrainTileId {
  std::uint32_t z = 0, x = 0, y = 0;
  std::string file_name() const {
    return std::to_string(z) + "/" + std::to_string(x) + "/" + std::to_string(y) + ".terrain";
  }
  friend auto operator<=>(const TerrainTileId&, const TerrainTileId&) = default;
};

struct TerrainOptions {
  double finest_error = 0;  ///< metres, of the last level, beyond Grid::snap_error()
  std::uint64_t cache_bytes = std::uint64_t{1} << 30;
};

class TerrainPyramid {
 public:
  /// @error as Cut::open; invalid_input: no terrain, or one that is nowhere on the Earth.
  static Result<std::unique_ptr<TerrainPyramid>> open(const std::filesystem::path& file,
                                                      const TerrainOptions& options);

  /// Whether open() would not refuse the file: a terrain whose place on the Earth is known.
  static bool is_possible(const Directory& directory);

  std::uint32_t last_level() const { return last_level_; }
  /// All that there are, by level; they hold the terrain's bounds, and both tiles of level 0.
  std::vector<TerrainTileId> tiles(std::uint32_t level) const;
  bool has(const TerrainTileId& id) const;
  double error_of(std::uint32_t level) const;

  /// @pre has(id)   @error of reading pages; out_of_budget.
  Result<TerrainTileMesh> mesh(const TerrainTileId& id);
  /// As a client reads it: gzip of quantized-mesh; over HTTP it is "Content-Encoding: gzip".
  static Result<std::vector<std::byte>> encode(const TerrainTileMesh& tile);
  std::string layer_json() const;

  const TerrainFacts& facts() const { return facts_; }
  /// Of an EPSG:4326 tile.
  static GeoBox box(const TerrainTileId& id);

 private:
  struct Columns {
    std::uint32_t first, count;
  };
  TerrainPyramid(std::unique_ptr<TileCut> cut, TerrainFacts facts, GeoBox bounds,
                 const TerrainOptions& options);
  Columns columns(std::uint32_t level) const;
  Columns rows(std::uint32_t level) const;
  SurfacePart part(const GeoBox& box) const;

  std::unique_ptr<TileCut> cut_;
  TerrainFacts facts_;
  GeoBox bounds_;
  TerrainOptions options_;
  TilePlacement placement_;
  std::uint32_t last_level_ = 0;
  double border_step_m_ = 1;  // heights on borders are multiples of it, so that neighbours store the same
};

}  // namespace cuesta::tiles
