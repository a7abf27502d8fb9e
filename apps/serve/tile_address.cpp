#include "apps/serve/tile_address.h"

namespace cuesta::serve {
namespace {

constexpr std::string_view tiles_prefix = "/tiles/", terrain_prefix = "/terrain/",
                           terrain_ending = ".terrain";

/// Divided before the last `parts` segments.
std::optional<TileAddress> divided(TileKind kind, std::string_view name_and_file, int parts) {
  std::size_t slash = name_and_file.size();
  for (; parts > 0; --parts) {
    if (slash == 0) return std::nullopt;
    slash = name_and_file.rfind('/', slash - 1);
    if (slash == name_and_file.npos) return std::nullopt;
  }
  const TileAddress address{kind, name_and_file.substr(0, slash), name_and_file.substr(slash + 1)};
  return address.dataset.empty() || address.file.empty() ? std::nullopt : std::optional(address);
}

}  // namespace

std::optional<TileAddress> parse_tile_address(std::string_view path) {
  if (path.starts_with(tiles_prefix)) return divided(TileKind::tiles_3d, path.substr(tiles_prefix.size()), 1);
  if (path.starts_with(terrain_prefix))
    return divided(TileKind::terrain, path.substr(terrain_prefix.size()),
                   path.ends_with(terrain_ending) ? 3 : 1);
  return std::nullopt;
}

TileFileType tile_file_type(std::string_view file) {
  if (file.ends_with(".glb")) return {"model/gltf-binary", ""};
  if (file.ends_with(terrain_ending)) return {"application/vnd.quantized-mesh", "Content-Encoding: gzip\r\n"};
  return {"application/json", ""};
}

}  // namespace cuesta::serve
