#pragma once
/// A picture laid over terrain: its colour at places on the Earth, bilinear between the middles of pixels.
///
/// A GeoTIFF lies where it says; JPEG, PNG and other TIFFs between bounds in degrees, in which rows are
/// parallels. One whose bounds go all around the Earth closes on itself. Pictures much finer than the
/// terrain's spacing should be made smaller first: a colour is of 4 pixels only. Threads: calls take turns.
/// Memory: cache_bytes and one block (ImagePixels).

#include <filesystem>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>

#include "ooc/result.h"
#include "ooc/surface_mesh.h"
#include "terrain/terrain_metadata.h"

namespace cuesta {

struct DrapeOptions {
  std::optional<GeoBox> bounds = {};  ///< outer edges of the picture; go before a GeoTIFF's own place
  std::uint64_t cache_bytes = std::uint64_t{64} << 20;
  std::filesystem::path temp = {};  ///< as for temp_folder(): 4 bytes a pixel of JPEG and PNG
};

class ImageDrape {
 public:
  /// @param path  JPEG, PNG or TIFF, perhaps in .gz, .zst or alone in a .zip.
  /// @error invalid_input: a picture that does not say where it lies, without bounds, or bounds without an
  /// area; of
  ///        open_raster_file() and open_image().
  static Result<ImageDrape> open(const std::filesystem::path& path, const DrapeOptions& options = {});

  ImageDrape(ImageDrape&&) noexcept;
  ImageDrape& operator=(ImageDrape&&) noexcept;
  ~ImageDrape();

  /// sRGB, alpha not multiplied in. {0, 0, 0, 0} where the picture does not lie, is transparent, or the place
  /// is NaN; its outer half pixels have the colour of their middle.
  /// @pre the spans are equally long.   @error corrupt, io: of decoding; then `out` is undefined.
  /// @cost  0.1 µs a place and the projection's, where blocks are in the cache.
  Result<void> sample(std::span<const LatLon> at, std::span<Rgba8> out) const;

  std::uint32_t width() const;
  std::uint32_t height() const;
  /// "relief.jpg, 21600 × 10800 pixels, EPSG:4326 …"
  std::string description() const;

 private:
  struct Data;
  explicit ImageDrape(std::unique_ptr<Data> data);
  std::unique_ptr<Data> data_;
};

/// "W,S,E,N" in degrees; an east that is less than west lies beyond the antimeridian. Nothing for what has no
/// area.
std::optional<GeoBox> parse_geo_box(std::string_view text);

}  // namespace cuesta
