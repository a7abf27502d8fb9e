#include "terrain/posting_store.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "ooc/check.h"

namespace cuesta {
namespace {

/// How many postings of the square that posting 0 lies in are before it.
std::uint64_t phase_of(double at_0, double spacing, std::uint32_t side) {
  const double number = std::round(at_0 / spacing);
  const double phase = number - std::floor(number / side) * side;
  return std::abs(number) < 1e15 ? static_cast<std::uint64_t>(phase) : 0;
}

}  // namespace

LatticeSquares::LatticeSquares(const std::vector<MosaicLayer>& layers, std::uint32_t side) : side_(side) {
  first_.push_back(0);
  for (const MosaicLayer& layer : layers) {
    const PostingMap& m = layer.map;
    column_.push_back({m.is_axis_aligned() ? phase_of(m.x0, m.x_per_column, side) : 0});
    row_.push_back({m.is_axis_aligned() ? phase_of(m.y0, m.y_per_row, side) : 0});
    extents_.push_back({layer.width, layer.height, layer.closes()});
    columns_.push_back(column_.back().square_of(layer.width - 1, side) + 1);
    first_.push_back(first_.back() + columns_.back() * (row_.back().square_of(layer.height - 1, side) + 1));
  }
}

LatticeSquare LatticeSquares::square(std::uint64_t number) const {
  CUESTA_CHECK(number < count(), number, count());
  const auto after = std::upper_bound(first_.begin(), first_.end(), number);
  const auto layer = static_cast<std::uint32_t>(after - first_.begin() - 1);
  const std::uint64_t i = (number - first_[layer]) % columns_[layer],
                      j = (number - first_[layer]) / columns_[layer];
  const auto start = [this](const Phase& phase, std::uint64_t square) { return phase.start(square, side_); };
  const std::uint64_t column = start(column_[layer], i), row = start(row_[layer], j);
  const std::uint64_t right = std::min(start(column_[layer], i + 1), extents_[layer].width);
  const std::uint64_t bottom = std::min(start(row_[layer], j + 1), extents_[layer].height);
  return {layer, column, row, static_cast<std::uint32_t>(right - column),
          static_cast<std::uint32_t>(bottom - row)};
}

std::uint32_t PostingStore::add(std::uint64_t square) {
  const std::uint32_t chunk = chunk_count();
  CUESTA_CHECK(chunk_of_[square] == no_chunk, square);
  chunk_of_[square] = chunk;
  square_of_.push_back(square);
  return chunk;
}

/// Rows of a square have the full side each, also at the rim.
Result<void> PostingStore::write(std::uint32_t chunk, std::span<const float> heights_m) const {
  const std::uint64_t side = squares_.side(), bytes = side * side * sizeof(float);
  const LatticeSquare at = squares_.square(square_of_[chunk]);
  if (at.width == side) return file_.write_at(chunk * bytes, std::as_bytes(heights_m));
  std::vector<float> rows(side * at.height, std::numeric_limits<float>::quiet_NaN());
  for (std::uint64_t r = 0; r < at.height; ++r)
    std::copy_n(heights_m.begin() + static_cast<std::ptrdiff_t>(r * at.width), at.width,
                rows.begin() + static_cast<std::ptrdiff_t>(r * side));
  return file_.write_at(chunk * bytes, std::as_bytes(std::span(rows)));
}

/// A run of a row of a square.
Result<void> PostingStore::read_run(std::uint64_t square, std::uint64_t column, std::uint64_t row,
                                    std::span<float> heights_m) const {
  const std::uint32_t chunk = chunk_of_[square];
  if (chunk == no_chunk) {
    std::fill(heights_m.begin(), heights_m.end(), std::numeric_limits<float>::quiet_NaN());
    return {};
  }
  const std::uint64_t side = squares_.side();
  const std::uint64_t posting = (chunk * side + row) * side + column;
  return file_.read_at(posting * sizeof(float), std::as_writable_bytes(heights_m));
}

Result<void> PostingStore::read(std::uint32_t layer, std::int64_t column, std::int64_t row,
                                std::uint64_t width, std::uint64_t height, std::span<float> heights_m) const {
  CUESTA_CHECK(heights_m.size() == width * height, heights_m.size(), width, height);
  const LatticeSquares::Extent& extent = squares_.extent(layer);
  const auto layer_width = static_cast<std::int64_t>(extent.width);
  for (std::uint64_t r = 0; r < height; ++r) {
    const std::int64_t at_row = row + static_cast<std::int64_t>(r);
    const auto out = heights_m.subspan(r * width, width);
    if (at_row < 0 || at_row >= static_cast<std::int64_t>(extent.height)) {
      std::fill(out.begin(), out.end(), std::numeric_limits<float>::quiet_NaN());
      continue;
    }
    for (std::uint64_t c = 0; c < width;) {
      std::int64_t at_column = column + static_cast<std::int64_t>(c);
      if (extent.closes) at_column = (at_column % layer_width + layer_width) % layer_width;
      if (at_column < 0 || at_column >= layer_width) {
        out[c++] = std::numeric_limits<float>::quiet_NaN();
        continue;
      }
      const std::uint64_t number = squares_.number_at(layer, static_cast<std::uint64_t>(at_column),
                                                      static_cast<std::uint64_t>(at_row));
      const LatticeSquare square = squares_.square(number);
      const std::uint64_t in_square = static_cast<std::uint64_t>(at_column) - square.column;
      const std::uint64_t run = std::min(square.width - in_square, width - c);
      const std::uint64_t row_in_square = static_cast<std::uint64_t>(at_row) - square.row;
      if (auto r2 = read_run(number, in_square, row_in_square, out.subspan(c, run)); !r2) return r2;
      c += run;
    }
  }
  return {};
}

}  // namespace cuesta
