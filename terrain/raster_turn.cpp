#include "terrain/raster_turn.h"

#include <cmath>
#include <utility>

namespace cuesta {
namespace {

PostingMap transposed(PostingMap m) {
  std::swap(m.x_per_column, m.x_per_row);
  std::swap(m.y_per_column, m.y_per_row);
  return m;
}

}  // namespace

RasterTurn RasterTurn::of(const RasterInfo& info) {
  RasterTurn turn{.width = info.width, .height = info.height};
  PostingMap m = info.map;
  // Of the two directions the one nearer to x; a tie is decided for the columns.
  turn.transposed = std::abs(m.x_per_column) * std::hypot(m.x_per_row, m.y_per_row) <
                    std::abs(m.x_per_row) * std::hypot(m.x_per_column, m.y_per_column);
  if (turn.transposed) {
    m = cuesta::transposed(m);
    std::swap(turn.width, turn.height);
  }
  turn.mirrored_columns = m.x_per_column < 0;
  const double area = m.x_per_column * m.y_per_row - m.y_per_column * m.x_per_row;
  turn.mirrored_rows = turn.mirrored_columns ? area < 0 : area > 0;
  return turn;
}

PostingMap RasterTurn::map(const PostingMap& file) const {
  PostingMap m = transposed ? cuesta::transposed(file) : file;
  const double last_column = mirrored_columns ? double(width - 1) : 0;
  const double last_row = mirrored_rows ? double(height - 1) : 0;
  const double x0 = m.x(last_column, last_row), y0 = m.y(last_column, last_row);
  m.x0 = x0;
  m.y0 = y0;
  if (mirrored_columns) {
    m.x_per_column = -m.x_per_column;
    m.y_per_column = -m.y_per_column;
  }
  if (mirrored_rows) {
    m.x_per_row = -m.x_per_row;
    m.y_per_row = -m.y_per_row;
  }
  return m;
}

Window RasterTurn::file_window(const Window& turned) const {
  Window window = turned;
  if (mirrored_columns) window.column = width - turned.column - turned.width;
  if (mirrored_rows) window.row = height - turned.row - turned.height;
  if (!transposed) return window;
  return {window.row, window.column, window.height, window.width};
}

void RasterTurn::turn(const Window& turned, std::span<const double> of_file, std::span<double> out) const {
  const std::uint64_t w = turned.width, h = turned.height;
  for (std::uint64_t r = 0; r < h; ++r) {
    for (std::uint64_t c = 0; c < w; ++c) {
      const std::uint64_t from_c = mirrored_columns ? w - 1 - c : c, from_r = mirrored_rows ? h - 1 - r : r;
      out[r * w + c] = of_file[transposed ? from_c * h + from_r : from_r * w + from_c];
    }
  }
}

}  // namespace cuesta
