#pragma once
/// Many rasters of which few are open at a time: one is opened when it is read, and the least recently used
/// are closed. What each says about itself is kept of all.
///
/// Threads: read() is concurrent; two threads that need a closed file open it once.
/// Memory: cache_bytes and what one more raster holds; beyond that as many as threads are reading at once.

#include <deque>
#include <mutex>

#include "terrain/height_raster.h"

namespace cuesta {

class OpenRasters {
 public:
  struct Limits {
    std::uint32_t files = 64;  ///< open at a time, at least 1
    std::uint64_t bytes = std::uint64_t{64} << 20;
  };

  OpenRasters(RasterOptions options, Limits limits) : options_(std::move(options)), limits_(limits) {}

  /// Opens a file to see what it is. Its number is that of files added before. @pre nothing is being read.
  Result<void> add(const std::filesystem::path& path);

  /// @error of open_height_raster() and HeightRaster::read(); corrupt: the file is not what it was when
  /// added.
  Result<void> read(std::uint32_t file, const Window& window, std::span<double> heights) const;

  const std::vector<RasterInfo>& infos() const { return infos_; }
  const std::filesystem::path& path(std::uint32_t file) const { return slots_[file].path; }
  std::uint32_t open_files() const;
  std::uint64_t memory_bytes() const { return limits_.bytes + largest_bytes_; }

 private:
  // Shared, so that a raster which is closed here stays open for those who are reading it.
  using Raster = std::shared_ptr<const HeightRaster>;
  struct Slot {
    std::filesystem::path path = {};
    std::mutex opening = {};
    Raster raster = nullptr;
    std::uint64_t last_use = 0;
  };
  Result<Raster> find(std::uint32_t file) const;
  Raster use(std::uint32_t file) const;
  void keep(std::uint32_t file, Raster raster) const;

  RasterOptions options_;
  Limits limits_;
  std::vector<RasterInfo> infos_;
  std::uint64_t largest_bytes_ = 0;

  mutable std::mutex mutex_;  // over all below but `opening`
  mutable std::deque<Slot> slots_;
  mutable std::vector<std::uint32_t> open_;
  mutable std::uint64_t clock_ = 0, open_bytes_ = 0;
};

}  // namespace cuesta
