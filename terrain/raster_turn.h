#pragma once
/// Rasters turned so that columns run along x and rows to their right, as in an image with north up.

#include "terrain/height_raster.h"

namespace cuesta {

/// Posting (c, r) of the turned raster is posting (c', r') of the file, where c' = c or width - 1 - c, r' = r
/// or height - 1 - r, and then, if transposed, both are exchanged. Sizes are those of the turned raster.
struct RasterTurn {
  std::uint64_t width = 0, height = 0;
  bool transposed = false, mirrored_columns = false, mirrored_rows = false;

  bool is_identity() const { return !transposed && !mirrored_columns && !mirrored_rows; }
  /// The turn that brings columns within 45° of x, and rows to their right.
  static RasterTurn of(const RasterInfo& info);
  /// Of the turned raster.
  PostingMap map(const PostingMap& file) const;
  /// The file's window that `turned` is. @pre it lies in the turned raster.
  Window file_window(const Window& turned) const;
  /// Heights of file_window(turned) to those of `turned`. @pre both are as large, and no part of each other.
  void turn(const Window& turned, std::span<const double> of_file, std::span<double> out) const;
};

}  // namespace cuesta
