#pragma once
/// A .cuesta file that is served, and what is told of it.

#include <memory>
#include <optional>
#include <string>

#include "apps/serve/folder_scan.h"
#include "apps/serve/served_file.h"
#include "apps/serve/tile_address.h"
#include "ooc/vec.h"

namespace cuesta::serve {

struct Dataset {
  std::string name;  ///< of its file below the path that is served, without ".cuesta"
  std::shared_ptr<const ServedFile> file;
  std::uint64_t triangles = 0, vertices = 0;  ///< of a scene: of all its parts, once each
  bool is_scene = false;                      ///< of many parts: it has no sessions
  Box3d box{{0, 0, 0}, {0, 0, 0}};  ///< world units; of a scene: of all its instances where they are at first
  bool is_terrain = false;
  bool is_on_earth = false;  ///< a terrain that quantized-mesh can be made of
  std::string attribution;   ///< of its metadata, else of "NAME.attribution" beside it; may be empty
  std::string json;          ///< all that is told of it, one line
  std::string brief_json;    ///< without rounds and metadata

  bool has_tiles(TileKind kind) const {
    return !is_scene && triangles > 0 && (kind == TileKind::tiles_3d || is_on_earth);
  }
  /// As ETag, without quotes.
  std::string version() const { return file->etag.substr(1, file->etag.size() - 2); }
};

inline constexpr std::string_view dataset_suffix = ".cuesta";

/// Opens and checks header and directory, and keeps the file open. Its ETag is made of the header's checksum,
/// which covers the directory's, which covers the pages': copies of a file have the same.
/// @error not_found if it is no longer what was found; as CuestaFile::open.
Result<Dataset> open_dataset(const FoundFile& found);

}  // namespace cuesta::serve
