#include "apps/tiles/tile_source.h"

#include <charconv>
#include <string_view>

namespace cuesta::tiles {
namespace {

Error no_such_file(const std::string& name) {
  return {ErrorCode::not_found, "", name, "there is no such tile"};
}

std::vector<std::byte> bytes_of(const std::string& text) {
  const auto bytes = std::as_bytes(std::span(text));
  return {bytes.begin(), bytes.end()};
}

/// What is before the ending; nothing where the name has another one.
std::optional<std::string> stem(const std::string& name, std::string_view ending) {
  if (!name.ends_with(ending)) return std::nullopt;
  return name.substr(0, name.size() - ending.size());
}

class Source3dTiles : public TileSource {
 public:
  explicit Source3dTiles(std::unique_ptr<TileProducer> producer) : producer_(std::move(producer)) {}

  Result<std::vector<TileFile>> make(const std::string& name) override {
    if (name == "tileset.json") {
      auto root = producer_->root_facts();
      if (!root) return fail(root.error());
      if (!*root) return fail(ErrorCode::not_found, "", "", "there are no triangles");
      return tileset(**root);
    }
    if (const auto id = stem(name, ".glb")) return content(name, *id);
    const auto id = stem(name, ".json");
    if (!id) return fail(no_such_file(name));
    const auto tile = producer_->facts(*id);
    if (!tile) return fail(tile.error());
    if (tile->leaf || tile->tile.path.empty()) return fail(no_such_file(name));
    return tileset(*tile);
  }

 private:
  Result<std::vector<TileFile>> tileset(const TileFacts& tile) {
    std::vector<TileFile> files(1);
    std::vector<TileFacts> children;
    for (const char digit : producer_->digits(tile.tile)) {
      auto child = producer_->child(tile.tile, digit);
      if (!child) return fail(child.error());
      if (!*child) continue;
      children.push_back((*child)->facts);
      files.push_back({children.back().tile.id() + ".glb", producer_->content(std::move(**child))});
    }
    files.front() = {tileset_name(tile.tile), bytes_of(tileset_file(*producer_, tile, children))};
    return files;
  }

  Result<std::vector<TileFile>> content(const std::string& name, const std::string& id) {
    auto tile = producer_->find(id);
    if (!tile) return fail(tile.error());
    std::vector<TileFile> files;
    files.push_back({name, producer_->content(std::move(*tile))});
    return files;
  }

  std::unique_ptr<TileProducer> producer_;
};

/// "3/10/5.terrain", without signs and leading zeros.
std::optional<TerrainTileId> terrain_tile(const std::string& name) {
  TerrainTileId id;
  const char* at = name.data();
  const char* const end = at + name.size();
  for (std::uint32_t* part : {&id.z, &id.x, &id.y}) {
    const auto read = std::from_chars(at, end, *part);
    if (read.ec != std::errc() || read.ptr == end) return std::nullopt;
    at = read.ptr + 1;
  }
  return id.file_name() == name ? std::optional(id) : std::nullopt;
}

class SourceTerrain : public TileSource {
 public:
  explicit SourceTerrain(std::unique_ptr<TerrainPyramid> pyramid) : pyramid_(std::move(pyramid)) {}

  Result<std::vector<TileFile>> make(const std::string& name) override {
    std::vector<TileFile> files;
    if (name == "layer.json") {
      files.push_back({name, bytes_of(pyramid_->layer_json())});
      return files;
    }
    const auto id = terrain_tile(name);
    if (!id || !pyramid_->has(*id)) return fail(no_such_file(name));
    const auto mesh = pyramid_->mesh(*id);
    if (!mesh) return fail(mesh.error());
    auto bytes = TerrainPyramid::encode(*mesh);
    if (!bytes) return fail(bytes.error());
    files.push_back({name, std::move(*bytes)});
    return files;
  }

 private:
  std::unique_ptr<TerrainPyramid> pyramid_;
};

}  // namespace

Result<std::unique_ptr<TileSource>> open_tile_source(const std::filesystem::path& file,
                                                     const TileOptions& options,
                                                     std::shared_ptr<KnownTiles> known) {
  auto producer = TileProducer::open(file, options, std::move(known));
  if (!producer) return fail(producer.error());
  return std::unique_ptr<TileSource>(std::make_unique<Source3dTiles>(std::move(*producer)));
}

Result<std::unique_ptr<TileSource>> open_terrain_source(const std::filesystem::path& file,
                                                        const TerrainOptions& options) {
  auto pyramid = TerrainPyramid::open(file, options);
  if (!pyramid) return fail(pyramid.error());
  return std::unique_ptr<TileSource>(std::make_unique<SourceTerrain>(std::move(*pyramid)));
}

std::string tileset_name(const Tile& tile) {
  return tile.path.empty() ? "tileset.json" : tile.id() + ".json";
}

std::string tileset_file(const TileProducer& producer, const TileFacts& tile,
                         std::span<const TileFacts> children) {
  return tileset_json(tile, children, tile.tile.path.empty() ? &producer.placement().transform() : nullptr);
}

}  // namespace cuesta::tiles
