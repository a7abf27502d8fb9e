#include "terrain/height_raster.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <cmath>

#include "ooc/check.h"
#include "ooc/read_job.h"
#include "terrain/raster_readers.h"
#include "terrain/raster_sidecar.h"

namespace cuesta {
namespace {

std::string lower(std::string_view text) {
  std::string out(text);
  for (char& c : out) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  return out;
}

/// The first word, in any case, is one of those that a grid's head consists of.
bool looks_like_ascii_grid(std::string_view text) {
  const std::size_t first = text.find_first_not_of(" \t\r\n");
  if (first == text.npos) return false;
  const std::string word = lower(text.substr(first, 16));
  for (const char* key : {"ncols", "nrows", "xllcorner", "xllcenter", "yllcorner", "yllcenter", "cellsize"}) {
    if (word.starts_with(key)) return true;
  }
  return false;
}

RasterFormat format_by_content(const RasterFile& file) {
  using namespace std::literals;
  for (const auto magic : {"II*\0"sv, "MM\0*"sv, "II+\0"sv, "MM\0+"sv}) {
    if (file.begins_with(magic)) return RasterFormat::geotiff;
  }
  if (file.begins_with("\x89PNG\r\n\x1a\n"sv)) return RasterFormat::png;
  for (const auto magic : {"CDF\1"sv, "CDF\2"sv, "CDF\5"sv, "\x89HDF\r\n\x1a\n"sv}) {
    if (file.begins_with(magic)) return RasterFormat::netcdf;
  }
  if (looks_like_usgs_dem(file.text())) return RasterFormat::usgs_dem;
  return looks_like_ascii_grid(file.text().substr(0, 256)) ? RasterFormat::ascii_grid : RasterFormat::detect;
}

RasterFormat format_of(const RasterFile& file, const RasterOptions& options) {
  if (options.format != RasterFormat::detect) return options.format;
  if (const RasterFormat format = format_by_content(file); format != RasterFormat::detect) return format;
  const std::string extension = lower(std::filesystem::path(file.inner_name).extension().string());
  if (extension == ".hgt") return RasterFormat::hgt;
  for (const char* raw : {".i16", ".u16", ".i32", ".f32", ".f64", ".raw", ".bin"}) {
    if (extension == raw) return RasterFormat::raw;
  }
  return RasterFormat::detect;
}

RasterResult open_as(RasterFormat format, RasterFile file, const RasterOptions& options) {
  switch (format) {
    case RasterFormat::hgt:
      return open_hgt(std::move(file), options);
    case RasterFormat::geotiff:
      return open_geotiff(std::move(file), options);
    case RasterFormat::ascii_grid:
      return open_ascii_grid(std::move(file), options);
    case RasterFormat::png:
      return open_png(std::move(file), options);
    case RasterFormat::raw:
      return open_raw(std::move(file), options);
    case RasterFormat::netcdf:
      return open_netcdf(std::move(file), options);
    case RasterFormat::usgs_dem:
      return open_usgs_dem(std::move(file), options);
    case RasterFormat::tiles:
      return file.error(ErrorCode::invalid_input, "",
                        "expected a folder of tiles, zoom/x/y.png; found a file");
    case RasterFormat::detect:
      break;
  }
  return file.error(
      ErrorCode::unsupported_version, "",
      "not a raster of heights: expected .hgt, GeoTIFF, ESRI ASCII grid, USGS DEM, PNG, netCDF, a folder of "
      "PNG tiles, or raw samples (name their format in the options or a sidecar)");
}

}  // namespace

Result<void> HeightRaster::read(const Window& window, std::span<double> heights) const {
  CUESTA_CHECK(window.width <= info_.width && window.column <= info_.width - window.width, window.column,
               window.width, info_.width);
  CUESTA_CHECK(window.height <= info_.height && window.row <= info_.height - window.height, window.row,
               window.height, info_.height);
  CUESTA_CHECK(heights.size() == window.width * window.height, heights.size(), window.width, window.height);
  if (heights.empty()) return {};
  return read_window(window, heights);
}

PostingMap map_of(const Placement& p) {
  const double shift = p.pixel_is == PixelIs::area ? 0.5 : 0.0;
  return {.x0 = p.x + shift * p.x_spacing,
          .y0 = p.y - shift * p.y_spacing,
          .x_per_column = p.x_spacing,
          .y_per_row = -p.y_spacing};
}

Result<void> check_options(const RasterOptions& options, const std::filesystem::path& path) {
  const auto wrong = [&](const char* message) {
    return fail(ErrorCode::invalid_input, path.string(), "options", message);
  };
  if (const auto& p = options.placement) {
    if (!std::isfinite(p->x) || !std::isfinite(p->y)) return wrong("the place is not a number");
    if (!(p->x_spacing > 0 && p->y_spacing > 0 && std::isfinite(p->x_spacing) && std::isfinite(p->y_spacing)))
      return wrong("expected spacings above 0");
  }
  if (options.scale && !(std::isfinite(*options.scale) && *options.scale != 0))
    return wrong("expected a scale other than 0");
  if (options.offset && !std::isfinite(*options.offset)) return wrong("expected an offset that is a number");
  if (options.unit_m && !(*options.unit_m > 0 && std::isfinite(*options.unit_m)))
    return wrong("expected a vertical unit of more than 0 metres");
  for (const auto& side : {options.width, options.height}) {
    if (side && (*side == 0 || *side > most_postings_per_side))
      return wrong("expected a width and height of 1 to 2^31 postings");
  }
  return {};
}

void apply_options(RasterInfo& info, const RasterOptions& options) {
  if (options.placement) {
    info.map = map_of(*options.placement);
    info.is_placed = true;
  }
  if (options.epsg) info.crs = {.kind = CrsDescription::Kind::epsg, .epsg = *options.epsg};
  if (options.vertical_datum) {
    info.vertical_datum = *options.vertical_datum;
    info.vertical_name.clear();
  }
  if (options.no_data) info.meaning.no_data = {*options.no_data};
  if (options.scale) info.meaning.scale = *options.scale;
  if (options.offset) info.meaning.offset = *options.offset;
  if (options.unit_m) info.meaning.unit_m = *options.unit_m;
}

Result<void> check_info(const RasterInfo& info, const RasterFile& file) {
  if (info.width == 0 || info.height == 0 || info.width > most_postings_per_side ||
      info.height > most_postings_per_side || info.width * info.height > most_postings)
    return file.error(ErrorCode::corrupt, "size",
                      fmt::format("expected 1 to 2^31 postings each way and 2^48 in all, found {} × {}",
                                  info.width, info.height));
  const PostingMap& m = info.map;
  for (const double value : {m.x0, m.y0, m.x_per_column, m.y_per_column, m.x_per_row, m.y_per_row}) {
    if (!std::isfinite(value))
      return file.error(ErrorCode::corrupt, "georeference", "the place of the postings is not a number");
  }
  const double area = m.x_per_column * m.y_per_row - m.x_per_row * m.y_per_column;
  if (area == 0 || !std::isfinite(area))
    return file.error(ErrorCode::corrupt, "georeference", "the spacing of the postings is 0");
  return {};
}

RasterResult open_raster(RasterFile file, const RasterOptions& options) {
  const RasterFormat format = format_of(file, options);
  return open_as(format, std::move(file), options);
}

Result<std::unique_ptr<HeightRaster>> open_height_raster(const std::filesystem::path& path,
                                                         const RasterOptions& given) {
  RasterOptions options = given;
  const auto sidecar = read_sidecar(path, options);
  if (!sidecar) return fail(sidecar.error());
  CUESTA_TRY(check_options(options, path));
  std::error_code ignored;
  RasterResult raster;
  if (std::filesystem::is_directory(path, ignored)) {
    raster = open_tile_folder(path, options);
  } else {
    auto file = open_raster_file(path, options.temp);
    if (!file) return fail(std::move(file).error());
    raster = open_raster(std::move(*file), options);
  }
  if (raster && *sidecar) (*raster)->info_.files.push_back(sidecar_path(path).string());
  return raster;
}

}  // namespace cuesta
