#include <algorithm>
#include <nlohmann/json.hpp>

#include "apps/tiles/tile_producer.h"

namespace cuesta::tiles {
namespace {

using Json = nlohmann::ordered_json;

Json volume_json(const TileVolume& volume) {
  return {{volume.is_region ? "region" : "box", volume.numbers}};
}

Json tile_json(const TileFacts& facts, bool elsewhere) {
  return {{"boundingVolume", volume_json(facts.volume)},
          {"geometricError", facts.geometric_error},
          {"refine", "REPLACE"},
          {"content", {{"uri", facts.tile.id() + (elsewhere ? ".json" : ".glb")}}}};
}

}  // namespace

std::string tileset_json(const TileFacts& tile, std::span<const TileFacts> children,
                         const std::array<double, 16>* transform) {
  Json root = tile_json(tile, false);
  for (const TileFacts& child : children) root["children"].push_back(tile_json(child, !child.leaf));
  if (transform) root["transform"] = *transform;
  Json json{{"asset", {{"version", "1.1"}, {"generator", "cuesta"}}}};
  // Without the tileset all of the surface is missing.
  json["geometricError"] = transform ? std::max(tile.geometric_error, tile.extent) : tile.geometric_error;
  json["root"] = std::move(root);
  return json.dump() + "\n";
}

}  // namespace cuesta::tiles
