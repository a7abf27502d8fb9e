#pragma once
/// Addresses of tiles: what an export has in a folder is below the data set's name.
///
///   /tiles/NAME/tileset.json, /tiles/NAME/t….json, /tiles/NAME/t….glb
///   /terrain/NAME/layer.json, /terrain/NAME/Z/X/Y.terrain

#include <cstdint>
#include <optional>
#include <string_view>

namespace cuesta::serve {

enum class TileKind : std::uint8_t { tiles_3d, terrain };

struct TileAddress {
  TileKind kind = TileKind::tiles_3d;
  std::string_view dataset, file;  ///< neither is empty; either may be of nothing that there is
};

/// @param path  decoded, as Target::path.   @return nothing for other addresses.
std::optional<TileAddress> parse_tile_address(std::string_view path);

/// What a client is told of an export's file. Files that have an encoding are sent as they are stored.
struct TileFileType {
  std::string_view content_type, header_lines;
};
TileFileType tile_file_type(std::string_view file);

}  // namespace cuesta::serve
