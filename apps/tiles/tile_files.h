#pragma once
/// Where exported tiles go: a folder, or one archive. Either appears under its name when it is whole.

#include <cstddef>
#include <filesystem>
#include <memory>
#include <span>
#include <string>

#include "ooc/result.h"

namespace cuesta::tiles {

class TileFiles {
 public:
  virtual ~TileFiles() = default;
  /// @param name  relative, with '/' between folders; each once.
  virtual Result<void> add(const std::string& name, std::span<const std::byte> bytes) = 0;
  /// The last call. Without it nothing stays.
  virtual Result<void> finish() = 0;
};

/// A folder that is not there yet; until it is whole it is `path`.part, and what is left there of an
/// interrupted export goes first.
/// @error invalid_input: there is something of that name; io.
Result<std::unique_ptr<TileFiles>> tile_folder(const std::filesystem::path& path);

/// An archive of 3D Tiles: stored files and, last, an index of their paths' MD5 that a client can search.
/// Source: "3D Tiles Archive Format (3tz)" 1.3.   @error io.
Result<std::unique_ptr<TileFiles>> tile_archive(const std::filesystem::path& path);

/// The archive for names that end in .3tz, else the folder.
Result<std::unique_ptr<TileFiles>> tile_files(const std::filesystem::path& path);

}  // namespace cuesta::tiles
