#include "apps/tiles/export_tiles.h"

#include <algorithm>
#include <string>

namespace cuesta::tiles {
namespace {

class TileExport {
 public:
  TileExport(TileProducer& producer, TileFiles& files, const TileProgress& progress, std::size_t levels)
      : producer_(producer), files_(files), progress_(progress), levels_(levels) {}

  Result<TilesReport> run() {
    auto root = producer_.root();
    if (!root) return fail(root.error());
    if (!*root) return fail(ErrorCode::invalid_input, "", "", "there are no triangles to export");
    report_.root_error = (*root)->facts.geometric_error;
    auto node = write_tile(std::move(**root), 0);
    if (!node) return fail(node.error());
    if (auto r = write_tileset("tileset.json", *node, &producer_.placement().transform()); !r)
      return fail(r.error());
    if (auto r = files_.finish(); !r) return fail(r.error());
    return report_;
  }

 private:
  /// The tile with what is below it; of what begins a tileset of its own, without.
  Result<TileNode> write_tile(TileProducer::Fitted&& tile, std::size_t depth) {
    TileNode node{tile.facts, {}};
    count(tile.facts, depth);
    const std::string id = tile.facts.tile.id();
    if (auto r = write(id + ".glb", producer_.content(std::move(tile))); !r) return fail(r.error());
    if (auto r = progress_(report_); !r) return fail(r.error());
    for (const char digit : producer_.digits(node.facts.tile)) {
      auto below = producer_.child(node.facts.tile, digit);
      if (!below) return fail(below.error());
      if (!*below) continue;
      auto child = write_tile(std::move(**below), depth + 1);
      if (!child) return child;
      node.children.push_back(std::move(*child));
    }
    if (depth > 0 && depth % levels_ == 0 && !node.facts.leaf) {
      if (auto r = write_tileset(id + ".json", node, nullptr); !r) return fail(r.error());
      node.children.clear();
    }
    return node;
  }

  Result<void> write_tileset(const std::string& name, const TileNode& node,
                             const std::array<double, 16>* transform) {
    ++report_.tilesets;
    const std::string text = tileset_json(node, transform);
    return write(name, std::as_bytes(std::span(text)));
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
  std::size_t levels_;
  TilesReport report_;
};

}  // namespace

Result<TilesReport> export_tiles(TileProducer& producer, TileFiles& files, const TileProgress& progress,
                                 std::size_t levels) {
  return TileExport(producer, files, progress, levels).run();
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
      const std::string name =
          std::to_string(id.z) + "/" + std::to_string(id.x) + "/" + std::to_string(id.y) + ".terrain";
      if (auto r = files.add(name, *bytes); !r) return fail(r.error());
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
