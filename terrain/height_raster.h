#pragma once
/// Rasters of heights of any size, read in windows. Behind it: SRTM, GeoTIFF, ESRI ASCII grid, PNG, web
/// tiles, raw samples, netCDF, USGS DEM.

#include <filesystem>
#include <memory>
#include <optional>
#include <span>

#include "ooc/result.h"
#include "terrain/raster_info.h"

namespace cuesta {

/// Postings [column, column + width) × [row, row + height).
struct Window {
  std::uint64_t column = 0, row = 0, width = 0, height = 0;
};

struct RasterOptions;

class HeightRaster {
 public:
  virtual ~HeightRaster() = default;
  const RasterInfo& info() const { return info_; }

  /// Heights of a window in metres above the file's vertical datum, as f64: exact for every sample type when
  /// scale, offset and unit are 1, 0 and 1. What is not a height is NaN; everything else is finite.
  /// @param heights  width · height, row by row. @pre the window lies in the raster.
  /// @error corrupt, io, out_of_budget: file and place; `heights` is then undefined.
  /// @cost  reads what the window touches: rows of uncompressed samples, else whole blocks (tiles, strips,
  ///        chunks, pieces of 2^17 postings of text). A window that touches more blocks than the cache holds
  ///        decodes each of them once; a second one decodes them again.
  /// Threads: calls are concurrent; those that decode take turns (of netCDF, over all rasters).
  Result<void> read(const Window& window, std::span<double> heights) const;

  /// What the raster holds in memory at most, apart from kilobytes of bookkeeping: the block cache, one block
  /// that is being decoded, and indices of blocks.
  virtual std::uint64_t memory_bytes() const = 0;

 protected:
  explicit HeightRaster(RasterInfo info) : info_(std::move(info)) {}
  virtual Result<void> read_window(const Window& window, std::span<double> heights) const = 0;
  friend Result<std::unique_ptr<HeightRaster>> open_height_raster(const std::filesystem::path& path,
                                                                  const RasterOptions& options);

  RasterInfo info_;
};

enum class RasterFormat : std::uint8_t {
  detect,
  hgt,
  geotiff,
  ascii_grid,
  png,
  tiles,
  raw,
  netcdf,
  usgs_dem
};
enum class ByteOrder : std::uint8_t { little, big };
enum class PixelIs : std::uint8_t { area, point };

/// How the channels of a PNG make a height.
enum class PngHeights : std::uint8_t {
  gray,         ///< one channel of 8 or 16 bits, with scale and offset
  terrain_rgb,  ///< -10000 + 0.1 · (65536 R + 256 G + B)
  terrarium,    ///< -32768 + 256 R + G + B / 256
};

/// Where a raster lies that does not say so itself.
struct Placement {
  double x = 0, y = 0;                  ///< of the upper left posting, or of the outer corner of its pixel
  double x_spacing = 1, y_spacing = 1;  ///< between columns eastward and rows southward, > 0
  PixelIs pixel_is =
      PixelIs::point;  ///< area: (x, y) is the corner, half a spacing north-west of the posting
};

/// What the user knows better than the file, or the file does not say. A sidecar (raster_sidecar.h) can say
/// the same; options go before it, and both before the file.
struct RasterOptions {
  RasterFormat format = RasterFormat::detect;
  std::optional<Placement> placement = {};
  std::optional<std::uint32_t> epsg = {};
  std::optional<VerticalDatum> vertical_datum = {};
  std::optional<double> no_data = {};  ///< instead of the file's own
  std::optional<double> scale = {}, offset = {}, unit_m = {};

  // raw
  std::optional<SampleType> type = {};
  std::optional<ByteOrder> byte_order = {};
  std::optional<std::uint64_t> width = {}, height = {}, header_bytes = {};

  std::optional<PngHeights> png_heights = {};
  std::optional<unsigned> zoom = {};         ///< tiles: level to read; without it the finest that is there
  std::optional<std::string> variable = {};  ///< netCDF: which one

  std::uint64_t cache_bytes = std::uint64_t{16} << 20;  ///< for decoded blocks; at least one is kept
  std::filesystem::path temp = {};  ///< folder for what must be unpacked as a whole, as for temp_folder()
};

/// A block (tile, strip, chunk) larger than this is not decoded at once: such strips are unpacked to a
/// temporary file, such tiles and chunks refused.
inline constexpr std::uint64_t largest_block_bytes = std::uint64_t{64} << 20;

/// Opens a raster; detects its format by content, then by name. A file in .gz, .zst, or alone in a .zip, is
/// unpacked to a temporary file without a name first. A folder is one of tiles, zoom/x/y.png.
/// @error not_found, io; unsupported_version: not a raster, or a kind of one that is not read; corrupt;
///        invalid_input: a wrong or missing option, named in the message; out_of_budget: a bomb.
Result<std::unique_ptr<HeightRaster>> open_height_raster(const std::filesystem::path& path,
                                                         const RasterOptions& options = {});

}  // namespace cuesta
