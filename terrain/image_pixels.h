#pragma once
/// Pictures as blocks of colours, a few at a time: TIFF tile by tile or strip by strip; JPEG and PNG, which
/// can only be read from front to back, unpacked once into a temporary file.

#include <memory>
#include <optional>

#include "ooc/surface_mesh.h"
#include "terrain/crs.h"
#include "terrain/raster_file.h"
#include "terrain/raster_info.h"

namespace cuesta {

/// Where a picture says it lies: the middle of pixel (column, row) by the map, in this system.
struct PicturePlace {
  PostingMap map;
  Crs crs;
};

class ImagePixels {
 public:
  virtual ~ImagePixels() = default;

  std::uint32_t width = 0, height = 0;              ///< each 1 to 2^24
  std::uint32_t block_width = 0, block_height = 0;  ///< at most 64 MiB of colours
  std::optional<PicturePlace> place;                ///< a GeoTIFF's own

  /// Block (bx, by): block_width · block_height colours, sRGB, premultiplied by their alpha; those beyond the
  /// edge of the picture hold anything. Not concurrent.   @error corrupt, io.
  virtual Result<void> load(std::uint32_t bx, std::uint32_t by, std::span<Rgba8> colours) = 0;
};

/// @param temp  as for temp_folder(). Takes 4 bytes of disk a pixel of JPEG and PNG.
/// @error unsupported_version: none of the formats, CMYK, 16 bits a channel in PNG, strips or interlaced
/// pictures larger
///        than 64 MiB, progressive JPEG larger than 256 MiB of coefficients; corrupt; out_of_budget: no room
///        on disk; as crs_of() for a GeoTIFF whose system is not known.
Result<std::unique_ptr<ImagePixels>> open_image(RasterFile file, const std::filesystem::path& temp);

}  // namespace cuesta
