#pragma once
/// libtiff over a RasterFile: no map, bounded allocations, messages kept instead of printed.

#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "terrain/raster_file.h"

typedef struct tiff TIFF;  // tiffio.h's own way

namespace cuesta {

/// Not thread-safe. The file moves in and stays; the handle itself never moves, as libtiff points to it.
class TiffHandle {
 public:
  /// libtiff refuses to allocate more than this at once: larger than a block, and than the offsets of 2^24.
  static constexpr std::uint64_t most_alloc_bytes = std::uint64_t{160} << 20;

  /// Opens the first image. @error corrupt, with libtiff's words
  static Result<std::unique_ptr<TiffHandle>> open(RasterFile file);
  ~TiffHandle();
  TiffHandle(const TiffHandle&) = delete;
  TiffHandle& operator=(const TiffHandle&) = delete;

  TIFF* tiff() const { return tiff_; }
  const RasterFile& file() const { return file_; }
  /// An error of the file with what libtiff said since the last one.
  tl::unexpected<Error> error(std::string place, std::string message);
  /// At most 8, in order, without repetitions.
  const std::vector<std::string>& warnings() const { return warnings_; }

  // Tags, checked for type and count by libtiff; empty where the file has none.
  std::span<const std::uint16_t> shorts(std::uint32_t tag) const;
  std::span<const double> doubles(std::uint32_t tag) const;
  std::string_view text(std::uint32_t tag) const;

  struct Calls;  ///< what libtiff calls

 private:
  explicit TiffHandle(RasterFile file) : file_(std::move(file)) {}

  RasterFile file_;
  std::uint64_t position_ = 0;
  std::string said_;
  std::vector<std::string> warnings_;
  TIFF* tiff_ = nullptr;
};

/// The tags of GeoTIFF and GDAL that libtiff does not know by itself.
namespace tiff_tag {
inline constexpr std::uint32_t pixel_scale = 33550, tie_points = 33922, transformation = 34264,
                               geo_keys = 34735, geo_doubles = 34736, geo_ascii = 34737,
                               gdal_metadata = 42112, gdal_no_data = 42113;
}  // namespace tiff_tag

/// Makes libtiff know those tags in all files that this process opens. Once is enough; TiffHandle does it.
void register_geotiff_tags();

}  // namespace cuesta
