#pragma once
/// Pictures of data sets for the start page, drawn off-screen by a thread of its own, one at a time, and
/// kept.

#include <functional>
#include <memory>
#include <string>

#include "apps/serve/dataset.h"
#include "ooc/result.h"

namespace cuesta::serve {

struct ThumbnailSettings {
  int width_px = 480, height_px = 360;
  std::uint64_t triangles = 200'000;
  std::uint64_t cache_bytes = 256ull << 20;  ///< of pages, while one is drawn
  std::uint64_t kept_bytes = 64ull << 20;    ///< of PNGs; those asked for longest ago are forgotten
  std::size_t most_waiting = 256;            ///< beyond, what is asked for is refused: out_of_budget
};

/// Threads: any.
class Thumbnails {
 public:
  using Done = std::function<void(Result<std::string>)>;

  static std::unique_ptr<Thumbnails> create(const ThumbnailSettings& settings);
  /// Those that wait get `cancelled`.
  virtual ~Thumbnails() = default;

  /// Gives `done` a PNG: at once if there is one, else from the drawing thread. The same for each content of
  /// a file.
  virtual void make(std::shared_ptr<const Dataset> set, Done done) = 0;
  virtual std::uint64_t drawn() const = 0;
};

}  // namespace cuesta::serve
