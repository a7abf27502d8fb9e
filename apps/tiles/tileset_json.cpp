#include <algorithm>
#include <nlohmann/json.hpp>

#include "apps/tiles/tile_producer.h"

namespace cuesta::tiles {
namespace {

using Json = nlohmann::ordered_json;

Json volume_json(const TileVolume& volume) {
  return {{volume.is_region ? "region" : "box", volume.numbers}};
}

Json tile_json(const TileNode& node, bool outermost) {
  const TileFacts& facts = node.facts;
  const bool elsewhere = !facts.leaf && node.children.empty() && !outermost;
  Json json{{"boundingVolume", volume_json(facts.volume)},
            {"geometricError", facts.geometric_error},
            {"refine", "REPLACE"},
            {"content", {{"uri", facts.tile.id() + (elsewhere ? ".json" : ".glb")}}}};
  for (const TileNode& child : node.children) json["children"].push_back(tile_json(child, false));
  return json;
}

}  // namespace

std::string tileset_json(const TileNode& node, const std::array<double, 16>* transform) {
  Json root = tile_json(node, true);
  if (transform) root["transform"] = *transform;
  const double error = node.facts.geometric_error;
  Json json{{"asset", {{"version", "1.1"}, {"generator", "cuesta"}}}};
  // Without the tileset all of the surface is missing.
  json["geometricError"] = transform ? std::max(error, node.facts.extent) : error;
  json["root"] = std::move(root);
  return json.dump() + "\n";
}

}  // namespace cuesta::tiles
