#pragma once
/// The heights of a mosaic in a work file, square by square: what a build reads again and again without
/// decoding rasters again.

#include <cstdint>
#include <span>
#include <vector>

#include "ooc/file_handle.h"
#include "ooc/result.h"
#include "terrain/mosaic.h"

namespace cuesta {

/// A square of a layer's lattice, cut off at the layer's rim.
struct LatticeSquare {
  std::uint32_t layer = 0;
  std::uint64_t column = 0, row = 0;
  std::uint32_t width = 0, height = 0;
};

/// How the lattices of all layers are cut into squares. Squares are numbered layer by layer, row by row.
/// Their sides lie where they do whatever files a layer has: counted from 0 of its system's coordinates.
class LatticeSquares {
 public:
  LatticeSquares(const std::vector<MosaicLayer>& layers, std::uint32_t side);

  std::uint32_t side() const { return side_; }
  std::uint64_t count() const { return first_.back(); }
  LatticeSquare square(std::uint64_t number) const;
  /// @pre the posting is in the layer
  std::uint64_t number_at(std::uint32_t layer, std::uint64_t column, std::uint64_t row) const {
    return first_[layer] + row_[layer].square_of(row, side_) * columns_[layer] +
           column_[layer].square_of(column, side_);
  }
  /// How far into its square a column or row is.
  std::uint32_t column_within(std::uint32_t layer, std::uint64_t column) const {
    return column_[layer].within(column, side_);
  }
  std::uint32_t row_within(std::uint32_t layer, std::uint64_t row) const {
    return row_[layer].within(row, side_);
  }
  struct Extent {
    std::uint64_t width = 0, height = 0;
    bool closes = false;
  };
  const Extent& extent(std::uint32_t layer) const { return extents_[layer]; }

 private:
  /// The first square along a side is cut off by `before` postings.
  struct Phase {
    std::uint64_t before = 0;
    std::uint64_t square_of(std::uint64_t i, std::uint64_t side) const { return (i + before) / side; }
    std::uint64_t start(std::uint64_t square, std::uint64_t side) const {
      return square == 0 ? 0 : square * side - before;
    }
    std::uint32_t within(std::uint64_t i, std::uint64_t side) const {
      return static_cast<std::uint32_t>(i - start(square_of(i, side), side));
    }
  };

  std::uint32_t side_;
  std::vector<Phase> column_, row_;  // by layer
  std::vector<Extent> extents_;
  std::vector<std::uint64_t> columns_, first_;  // squares in a row, and before the layer
};

inline constexpr std::uint32_t no_chunk = 0xFFFFFFFFu;

/// 4 bytes a posting of squares that have heights. Reads are concurrent.
class PostingStore {
 public:
  PostingStore(LatticeSquares squares, FileHandle file)
      : squares_(std::move(squares)), file_(std::move(file)), chunk_of_(squares_.count(), no_chunk) {}

  const LatticeSquares& squares() const { return squares_; }
  std::uint32_t chunk_count() const { return static_cast<std::uint32_t>(square_of_.size()); }
  std::uint64_t square_of(std::uint32_t chunk) const { return square_of_[chunk]; }
  /// no_chunk for a square without heights.
  std::uint32_t chunk_of(std::uint64_t square) const { return chunk_of_[square]; }

  /// The next chunk is this square, which has these heights, or is known to be written already. One thread at
  /// a time.
  std::uint32_t add(std::uint64_t square);
  Result<void> write(std::uint32_t chunk, std::span<const float> heights_m) const;

  /// Heights of a window, NaN outside of squares with heights. Columns go around where the layer closes on
  /// itself.
  Result<void> read(std::uint32_t layer, std::int64_t column, std::int64_t row, std::uint64_t width,
                    std::uint64_t height, std::span<float> heights_m) const;

 private:
  Result<void> read_run(std::uint64_t square, std::uint64_t column, std::uint64_t row,
                        std::span<float> heights_m) const;

  LatticeSquares squares_;
  FileHandle file_;
  std::vector<std::uint32_t> chunk_of_;
  std::vector<std::uint64_t> square_of_;
};

}  // namespace cuesta
