#include "terrain/block_raster.h"

#include <algorithm>

#include "terrain/samples.h"

namespace cuesta {

BlockRaster::BlockRaster(RasterInfo info, const Blocks& blocks, std::uint64_t cache_bytes, std::mutex* turns)
    : HeightRaster(std::move(info)),
      blocks_(blocks),
      block_bytes_(blocks.width * blocks.height * bytes_of(blocks.type)),
      index_bytes_(blocks.index_bytes),
      places_(std::max<std::uint64_t>(1, cache_bytes / block_bytes_)),
      turns_(turns ? turns : &own_turns_) {}

Result<void> BlockRaster::read_window(const Window& window, std::span<double> heights) const {
  const std::uint64_t last_x = (window.column + window.width - 1) / blocks_.width;
  const std::uint64_t last_y = (window.row + window.height - 1) / blocks_.height;
  for (std::uint64_t by = window.row / blocks_.height; by <= last_y; ++by) {
    for (std::uint64_t bx = window.column / blocks_.width; bx <= last_x; ++bx) {
      const std::scoped_lock lock(*turns_);
      const auto place = find(bx, by);
      if (!place) return fail(place.error());
      copy(**place, bx, by, window, heights);
    }
  }
  return {};
}

Result<const BlockRaster::Place*> BlockRaster::find(std::uint64_t bx, std::uint64_t by) const {
  const std::uint64_t per_row = (info_.width + blocks_.width - 1) / blocks_.width;
  const std::uint64_t block = by * per_row + bx;
  if (const auto held = place_of_.find(block); held != place_of_.end()) {
    cache_[held->second].last_use = ++clock_;
    return &cache_[held->second];
  }
  Place& place = oldest_place();
  place_of_.erase(std::exchange(place.block, ~std::uint64_t{0}));
  place.samples.resize(block_bytes_);
  auto loaded = load_block(bx, by, place.samples);
  if (!loaded) return fail(std::move(loaded).error());
  place.block = block;
  place.last_use = ++clock_;
  place_of_[block] = static_cast<std::size_t>(&place - cache_.data());
  return &place;
}

BlockRaster::Place& BlockRaster::oldest_place() const {
  if (cache_.size() < places_) return cache_.emplace_back();
  return *std::min_element(cache_.begin(), cache_.end(),
                           [](const Place& a, const Place& b) { return a.last_use < b.last_use; });
}

void BlockRaster::copy(const Place& place, std::uint64_t bx, std::uint64_t by, const Window& window,
                       std::span<double> heights) const {
  const std::uint64_t left = std::max(window.column, bx * blocks_.width);
  const std::uint64_t right = std::min(window.column + window.width, (bx + 1) * blocks_.width);
  const std::uint64_t top = std::max(window.row, by * blocks_.height);
  const std::uint64_t bottom = std::min(window.row + window.height, (by + 1) * blocks_.height);
  const std::size_t each = bytes_of(blocks_.type);
  for (std::uint64_t row = top; row < bottom; ++row) {
    const std::uint64_t from = (row - by * blocks_.height) * blocks_.width + (left - bx * blocks_.width);
    const std::uint64_t to = (row - window.row) * window.width + (left - window.column);
    to_heights(std::span<const std::byte>(place.samples).subspan(from * each, (right - left) * each),
               blocks_.type, ByteOrder::little, info_.meaning, heights.subspan(to, right - left));
  }
}

}  // namespace cuesta
