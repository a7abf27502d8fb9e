#pragma once
/// What was found out of a file's tiles, by path: producers of one file may share it.

#include <mutex>
#include <optional>
#include <string>
#include <unordered_map>
#include <utility>

#include "apps/tiles/tile_volume.h"

namespace cuesta::tiles {

/// One tile of the tree, by its place and its error.
struct Tile {
  std::string path;  ///< TileTree's digits; empty: the root
  int rung = 0;      ///< 0: full resolution, then errors that grow by √2

  /// "t", "t03-7": its name in URLs.
  std::string id() const { return "t" + path + "-" + std::to_string(rung); }
};

/// What its parent says of it.
struct TileFacts {
  Tile tile;
  double geometric_error = 0;  ///< bound of the distance from the original's vertices, file's units
  TileVolume volume;
  double extent = 0;  ///< the diagonal of the content's box, file's units
  std::uint64_t triangles = 0;
  bool leaf = false;
};

/// Threads: any. Memory: some 300 bytes for each path that was looked at, of which there are at most eight
/// for each tile of the file.
class KnownTiles {
 public:
  /// Nothing there: no surface is in this part of space.
  using Fact = std::optional<TileFacts>;

  std::optional<Fact> find(const std::string& path) const {
    const std::lock_guard lock(mutex_);
    const auto at = facts_.find(path);
    return at == facts_.end() ? std::nullopt : std::optional<Fact>(at->second);
  }
  void keep(const std::string& path, Fact fact) {
    const std::lock_guard lock(mutex_);
    facts_.try_emplace(path, std::move(fact));
  }

 private:
  mutable std::mutex mutex_;
  std::unordered_map<std::string, Fact> facts_;
};

}  // namespace cuesta::tiles
