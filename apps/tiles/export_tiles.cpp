#include "apps/tiles/export_tiles.h"

#include <algorithm>
#include <string>

#include "apps/tiles/tile_source.h"

namespace cuesta::tiles {
namespace {

class TileExport {
 public:
  TileExport(TileProducer& producer, TileFiles& files, const TileProgress& progress)
      : producer_(producer), files_(files), progress_(progress) {}

  Result<TilesReport> run() {
    auto root = producer_.root();
    if (!root) return fail(root.error());
    if (!*root) return fail(ErrorCode::invalid_input, "", "", "there are no triangles to export");
    report_.root_error = (*root)->facts.geometric_error;
    if (auto r = write_tile(std::move(**root), 0); !r) return fail(r.error());
    if (auto r = files_.finish(); !r) return fail(r.error());
    return report_;
  }

 private:
  /// The tile and all below it.
  Result<void> write_tile(TileProducer::Fitted&& tile, std::size_t depth) {
    const TileFacts facts = tile.facts;
    count(facts, depth);
    if (auto r = write(facts.tile.id() + ".glb", producer_.content(std::move(tile))); !r) return r;
    if (auto r = progress_(report_); !r) return r;
    std::vector<TileFacts> children;
    for (const char digit : producer_.digits(facts.tile)) {
      auto below = producer_.child(facts.tile, digit);
      if (!below) return fail(below.error());
      if (!*below) continue;
      children.push_back((*below)->facts);
      if (auto r = write_tile(std::move(**below), depth + 1); !r) return r;
    }
    return depth > 0 && facts.leaf ? Result<void>() : write_tileset(facts, children);
  }

  Result<void> write_tileset(const TileFacts& tile, const std::vector<TileFacts>& children) {
    ++report_.tilesets;
    const std::string text = tileset_file(producer_, tile, children);
    return write(tileset_name(tile.tile), std::as_bytes(std::span(text)));
  }

  Result<void> write(const std::string& name, std::span<const std::byte> bytes) {
    report_.bytes += bytes.size();
    return files_.add(name, bytes);
  }

  void count(const TileFacts& facts, std::size_t depth) {
    ++report_.tiles;
    report_.leaves += facts.leaf;
    report_.triangles += facts.triangles;
    report_.levels = std::max<std::uint64_t>(report_.levels, depth + 1);
  }

  TileProducer& producer_;
  TileFiles& files_;
  const TileProgress& progress_;
  TilesReport report_;
};

}  // namespace

Result<TilesReport> export_tiles(TileProducer& producer, TileFiles& files, const TileProgress& progress) {
  return TileExport(producer, files, progress).run();
}

Result<TilesReport> export_terrain(TerrainPyramid& pyramid, TileFiles& files, const TileProgress& progress) {
  TilesReport report;
  const std::string layer = pyramid.layer_json();
  if (auto r = files.add("layer.json", std::as_bytes(std::span(layer))); !r) return fail(r.error());
  report.bytes = layer.size();
  report.levels = pyramid.last_level() + 1;
  report.root_error = pyramid.error_of(0);
  for (std::uint32_t level = 0; level <= pyramid.last_level(); ++level)
    for (const TerrainTileId& id : pyramid.tiles(level)) {
      auto mesh = pyramid.mesh(id);
      if (!mesh) return fail(mesh.error());
      auto bytes = TerrainPyramid::encode(*mesh);
      if (!bytes) return fail(bytes.error());
      if (auto r = files.add(id.file_name(), *bytes); !r) return fail(r.error());
      ++report.tiles;
      report.leaves += level == pyramid.last_level();
      report.triangles += mesh->triangles.size();
      report.bytes += bytes->size();
      if (auto r = progress(report); !r) return fail(r.error());
    }
  if (auto r = files.finish(); !r) return fail(r.error());
  return report;
}

}  // namespace cuesta::tiles
