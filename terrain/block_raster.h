#pragma once
/// A raster that is decoded in blocks of one size, of which the last used ones stay in memory.

#include <mutex>
#include <unordered_map>

#include "terrain/height_raster.h"

namespace cuesta {

/// Least recently used first out. Bytes of blocks, not heights: a posting takes what the file's type takes.
class BlockRaster : public HeightRaster {
 public:
  struct Blocks {
    SampleType type = SampleType::i16;    ///< as load_block() gives them, little-endian
    std::uint64_t width = 1, height = 1;  ///< of a block, in postings
    std::uint64_t index_bytes = 0;        ///< what the format holds to find its blocks
  };

  std::uint64_t memory_bytes() const override { return (places_ + 1) * block_bytes_ + index_bytes_; }

 protected:
  /// @param turns  the mutex that load_block() runs under; null: one of this raster's own.
  BlockRaster(RasterInfo info, const Blocks& blocks, std::uint64_t cache_bytes, std::mutex* turns = nullptr);

  /// Decodes block (bx, by): all its width · height samples; those beyond the raster's edge are ignored.
  virtual Result<void> load_block(std::uint64_t bx, std::uint64_t by, std::span<std::byte> samples) const = 0;
  Result<void> read_window(const Window& window, std::span<double> heights) const override;

 private:
  struct Place {
    std::uint64_t block = ~std::uint64_t{0}, last_use = 0;
    std::vector<std::byte> samples;
  };
  Result<const Place*> find(std::uint64_t bx, std::uint64_t by) const;
  Place& oldest_place() const;
  void copy(const Place& place, std::uint64_t bx, std::uint64_t by, const Window& window,
            std::span<double> heights) const;

  Blocks blocks_;
  std::uint64_t block_bytes_, index_bytes_, places_;
  mutable std::mutex own_turns_;
  std::mutex* turns_;
  mutable std::vector<Place> cache_;
  mutable std::unordered_map<std::uint64_t, std::size_t> place_of_;  ///< of each cached block
  mutable std::uint64_t clock_ = 0;
};

}  // namespace cuesta
