/// A folder of web tiles, zoom/x/y.png, one zoom level of it as one raster in EPSG:3857; y counts from the
/// north. Tiles that are not there are no data. Source: Mapbox "Raster tiles"; Mapzen "Terrain tiles".

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cstring>
#include <numbers>

#include "ooc/read_job.h"
#include "terrain/block_raster.h"
#include "terrain/png_image.h"
#include "terrain/raster_readers.h"
#include "terrain/samples.h"

namespace cuesta {
namespace {

namespace fs = std::filesystem;
constexpr unsigned finest_zoom = 22;
/// Half of the world's width in EPSG:3857: π times the equator's radius of WGS 84.
constexpr double half_world_m = std::numbers::pi * 6378137.0;

std::optional<std::uint32_t> number_of(const std::string& text) {
  std::uint32_t value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (text.empty() || error != std::errc{} || end != text.data() + text.size()) return std::nullopt;
  return value;
}

tl::unexpected<Error> folder_error(const fs::path& folder, std::string message) {
  return fail(ErrorCode::invalid_input, folder.string(), "", std::move(message));
}

/// Calls `f` with the number that names each entry with this extension; others are passed over.
template <class F>
Result<void> each_number(const fs::path& folder, const char* extension, F&& f) {
  std::error_code error;
  for (fs::directory_iterator at(folder, error), end; !error && at != end; at.increment(error)) {
    const fs::path& path = at->path();
    if (path.extension() != extension) continue;
    if (const auto number = number_of(path.stem().string())) f(*number);
  }
  if (!error) return {};
  return fail(error == std::errc::no_such_file_or_directory ? ErrorCode::not_found : ErrorCode::io,
              folder.string(), "", "cannot be listed: " + error.message());
}

struct TileRange {
  std::uint32_t left = ~0u, top = ~0u, right = 0, bottom = 0;  ///< inclusive
  bool is_empty() const { return left > right; }
  void add(std::uint32_t x, std::uint32_t y) {
    left = std::min(left, x);
    right = std::max(right, x);
    top = std::min(top, y);
    bottom = std::max(bottom, y);
  }
};

Result<unsigned> zoom_of(const fs::path& folder, const RasterOptions& options) {
  std::optional<unsigned> finest;
  CUESTA_TRY(each_number(folder, "", [&](std::uint32_t zoom) {
    if (zoom <= finest_zoom && (!finest || zoom > *finest)) finest = zoom;
  }));
  if (options.zoom && *options.zoom > finest_zoom) return folder_error(folder, "expected a zoom of 0 to 22");
  if (options.zoom) return *options.zoom;
  if (!finest) return folder_error(folder, "expected tiles, zoom/x/y.png; found no folder of a zoom level");
  return *finest;
}

Result<TileRange> range_of(const fs::path& level, unsigned zoom) {
  TileRange range;
  const std::uint32_t side = std::uint32_t{1} << zoom;
  std::vector<std::uint32_t> columns;
  CUESTA_TRY(each_number(level, "", [&](std::uint32_t x) {
    if (x < side) columns.push_back(x);
  }));
  for (const std::uint32_t x : columns) {
    CUESTA_TRY(each_number(level / std::to_string(x), ".png", [&](std::uint32_t y) {
      if (y < side) range.add(x, y);
    }));
  }
  return range;
}

class TileFolder final : public BlockRaster {
 public:
  TileFolder(RasterInfo info, const TileRange& range, std::uint32_t side, PngHeights heights, fs::path level,
             const RasterOptions& options)
      : BlockRaster(std::move(info), {SampleType::u32, side, side, 0}, options.cache_bytes),
        range_(range),
        side_(side),
        heights_(heights),
        level_(std::move(level)),
        temp_(options.temp) {}

  fs::path tile_path(std::uint64_t bx, std::uint64_t by) const {
    return level_ / std::to_string(range_.left + bx) / (std::to_string(range_.top + by) + ".png");
  }

 protected:
  Result<void> load_block(std::uint64_t bx, std::uint64_t by, std::span<std::byte> samples) const override {
    const fs::path path = tile_path(bx, by);
    auto file = open_raster_file(path, temp_);
    if (!file && file.error().code == ErrorCode::not_found) {
      std::fill(samples.begin(), samples.end(), std::byte{0xFF});  // transparent_sample
      return {};
    }
    if (!file) return fail(std::move(file).error());
    const auto image = read_png_head(*file, heights_);
    if (!image) return fail(image.error());
    if (image->width != side_ || image->height != side_)
      return file->error(ErrorCode::corrupt, "head",
                         fmt::format("expected {} × {} pixels as of other tiles, found {} × {}", side_, side_,
                                     image->width, image->height));
    std::size_t at = 0;
    return decode_png(*file, heights_, [&](std::span<const std::byte> row) -> Result<void> {
      std::memcpy(samples.data() + at, row.data(), row.size());
      at += row.size();
      return {};
    });
  }

 private:
  TileRange range_;
  std::uint32_t side_;
  PngHeights heights_;
  fs::path level_, temp_;
};

/// Size of a tile, of any that is there.
Result<std::uint32_t> tile_side(const fs::path& level, const TileRange& range, PngHeights heights,
                                const fs::path& temp) {
  fs::path some;
  const fs::path column = level / std::to_string(range.left);
  CUESTA_TRY(
      each_number(column, ".png", [&](std::uint32_t y) { some = column / (std::to_string(y) + ".png"); }));
  auto file = open_raster_file(some, temp);
  if (!file) return fail(std::move(file).error());
  const auto image = read_png_head(*file, heights);
  if (!image) return fail(image.error());
  if (image->width != image->height || image->width > 4096)
    return file->error(ErrorCode::unsupported_version, "head",
                       fmt::format("expected a square tile of at most 4096 pixels, found {} × {}",
                                   image->width, image->height));
  return image->width;
}

/// Pixels are areas: the postings are their middles.
Placement placement_of(const TileRange& range, unsigned zoom, std::uint32_t side) {
  const double tile_m = 2 * half_world_m / double(std::uint32_t{1} << zoom);
  return {.x = -half_world_m + range.left * tile_m,
          .y = half_world_m - range.top * tile_m,
          .x_spacing = tile_m / side,
          .y_spacing = tile_m / side,
          .pixel_is = PixelIs::area};
}

}  // namespace

RasterResult open_tile_folder(const fs::path& folder, const RasterOptions& options) {
  if (!options.png_heights || *options.png_heights == PngHeights::gray)
    return folder_error(folder,
                        "of a folder of tiles it must be known how colours are heights; give png_heights "
                        "(terrain-rgb or terrarium) in the options or in raster.json");
  const auto zoom = zoom_of(folder, options);
  if (!zoom) return fail(zoom.error());
  const fs::path level = folder / std::to_string(*zoom);
  const auto range = range_of(level, *zoom);
  if (!range) return fail(range.error());
  if (range->is_empty()) return folder_error(level, "expected tiles, x/y.png; found none");
  const auto side = tile_side(level, *range, *options.png_heights, options.temp);
  if (!side) return fail(side.error());
  RasterInfo info{.width = std::uint64_t{range->right - range->left + 1} * *side,
                  .height = std::uint64_t{range->bottom - range->top + 1} * *side,
                  .is_placed = true,
                  .type = SampleType::u32,
                  .format = "tiles"};
  info.map = map_of(placement_of(*range, *zoom, *side));
  info.crs = {.kind = CrsDescription::Kind::epsg, .epsg = 3857};
  info.vertical_datum = VerticalDatum::unknown;
  info.meaning = meaning_of(*options.png_heights);
  info.files = {folder.string()};
  apply_options(info, options);
  // Whoever sets another no-data value still gets no heights where tiles are missing or transparent.
  if (options.no_data) info.meaning.no_data.push_back(transparent_sample);
  CUESTA_TRY(check_info(info, RasterFile{.path = folder}));
  return std::make_unique<TileFolder>(std::move(info), *range, *side, *options.png_heights, level, options);
}

}  // namespace cuesta
