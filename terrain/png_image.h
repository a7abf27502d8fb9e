#pragma once
/// PNG pictures as samples of heights, row by row, through libpng.

#include <functional>
#include <span>

#include "terrain/height_raster.h"
#include "terrain/raster_file.h"

namespace cuesta {

struct PngImage {
  std::uint32_t width = 0, height = 0;
  SampleType type = SampleType::u16;  ///< gray: u8 or u16; colours: u32, 65536 R + 256 G + B
};

/// In colours, the sample of a pixel that is transparent: no height.
inline constexpr std::uint32_t transparent_sample = 0xFFFFFFFF;

/// Receives each row in order, width samples of the image's type, little-endian.
using PngRows = std::function<Result<void>(std::span<const std::byte> row)>;

/// Size and type, from the head alone.
/// @error corrupt: not a PNG, or damaged; unsupported_version: gray is asked for but it has colours, fewer
/// than 8 bits, or transparency; colours are asked for and have 16 bits; it is interlaced and larger than
/// largest_block_bytes.
Result<PngImage> read_png_head(const RasterFile& file, PngHeights heights);

/// All rows. @error as read_png_head(), corrupt: damaged or cut off; what `rows` returned.
/// @cost one row of memory and libpng's window; interlaced: the whole picture.
Result<void> decode_png(const RasterFile& file, PngHeights heights, const PngRows& rows);

/// Scale, offset and no-data of `heights`: terrain_rgb 0.1 and -10000, terrarium 1/256 and -32768.
SampleMeaning meaning_of(PngHeights heights);

}  // namespace cuesta
