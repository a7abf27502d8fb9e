#pragma once
/// The files of exports, made when they are asked for, by threads of their own. What was made is kept for a
/// while; what is asked for twice at once is made once.

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "apps/serve/dataset.h"
#include "apps/serve/kept_tiles.h"
#include "apps/serve/metrics.h"
#include "apps/serve/response.h"
#include "apps/serve/tile_address.h"
#include "ooc/result.h"

namespace cuesta::serve {

/// Memory: threads · (cache_bytes + a tile in the making, some 30 MB), kept_bytes, and what KnownTiles has of
/// each data set that is served.
struct LiveTileSettings {
  std::uint32_t threads = 2;                 ///< that make tiles; each has one file open at a time
  std::uint64_t cache_bytes = 512ull << 20;  ///< of the pages of each such file
  std::uint64_t kept_bytes = 128ull << 20;   ///< of files that were made
  std::size_t most_waiting = 256;            ///< files; beyond, what is asked for is refused: out_of_budget
  std::uint32_t idle_ms = 30'000;            ///< after which a thread without work closes its file
};

/// Threads: any.
class LiveTiles {
 public:
  using Done = std::function<void(const Result<KeptTiles::Bytes>&)>;

  static std::unique_ptr<LiveTiles> start(const LiveTileSettings& settings);
  /// Those that wait get `cancelled`.
  virtual ~LiveTiles() = default;

  /// Gives `done` the file, with the bytes that `cuesta export` writes: at once if it is kept, else from the
  /// thread that made it. What all that asked have gone before is not made, nor answered.
  /// @error not_found: an export has no such file. Damage and failures of the disk are those of the moment:
  ///   they are not kept, and the file is opened anew.
  virtual void make(std::shared_ptr<const Dataset> set, TileKind kind, const std::string& file, Client client,
                    Done done) = 0;
  virtual std::vector<Gauge> gauges() const = 0;
};

}  // namespace cuesta::serve
