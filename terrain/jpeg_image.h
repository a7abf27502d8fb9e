#pragma once
/// JPEG pictures row by row, through libjpeg.

#include <functional>
#include <span>

#include "ooc/surface_mesh.h"
#include "terrain/raster_file.h"

namespace cuesta {

struct JpegSize {
  std::uint32_t width = 0, height = 0;
};

/// Receives each row in order.
using JpegRows = std::function<Result<void>(std::span<const Rgba8> row)>;

/// libjpeg holds all coefficients of a progressive picture: at most so many bytes of them are read.
inline constexpr std::uint64_t most_jpeg_coefficient_bytes = std::uint64_t{256} << 20;

/// From the head alone.   @error corrupt; unsupported_version: CMYK, or progressive and too large.
Result<JpegSize> read_jpeg_head(const RasterFile& file);

/// All rows, gray ones as colours.
/// @error as above; corrupt: also where the file ends too early, or has more than 500 scans; what `rows`
/// returned.
Result<void> decode_jpeg(const RasterFile& file, const JpegRows& rows);

}  // namespace cuesta
