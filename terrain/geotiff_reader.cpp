/// GeoTIFF: the first image of a TIFF, one channel, in strips or tiles; what follows (overviews, masks) is
/// not looked at. Sources: OGC 19-008r4; Aldus, "TIFF 6.0"; GDAL's tags 42112 and 42113.

#include <fmt/format.h>
#include <tiffio.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "ooc/compressed_stream.h"
#include "ooc/read_job.h"
#include "ooc/temp_file.h"
#include "ooc/text_cursor.h"
#include "terrain/block_raster.h"
#include "terrain/esri_sidecars.h"
#include "terrain/geo_keys.h"
#include "terrain/raster_readers.h"
#include "terrain/sample_file.h"
#include "terrain/samples.h"
#include "terrain/tiff_handle.h"
#include "terrain/tiff_placement.h"

namespace cuesta {
namespace {

/// Larger strips are unpacked to a temporary file row by row, as much of one is needed for any of its rows.
constexpr std::uint64_t largest_strip_bytes = std::uint64_t{4} << 20;

constexpr std::array<std::uint16_t, 8> compressions{
    COMPRESSION_NONE,    COMPRESSION_LZW,  COMPRESSION_PACKBITS, COMPRESSION_ADOBE_DEFLATE,
    COMPRESSION_DEFLATE, COMPRESSION_ZSTD, COMPRESSION_LZMA,     COMPRESSION_LERC};

struct Layout {
  std::uint32_t width = 0, height = 0;
  SampleType type = SampleType::u16;
  std::uint16_t compression = COMPRESSION_NONE;
  bool is_tiled = false;
  std::uint32_t block_width = 0, block_height = 0;
  std::uint64_t block_bytes() const { return std::uint64_t{block_width} * block_height * bytes_of(type); }
};

std::uint16_t short_field(TIFF* tiff, std::uint32_t tag, std::uint16_t otherwise) {
  std::uint16_t value = 0;
  return TIFFGetFieldDefaulted(tiff, tag, &value) ? value : otherwise;
}

std::optional<SampleType> type_of(std::uint16_t bits, std::uint16_t format) {
  struct Row {
    std::uint16_t bits, format;
    SampleType type;
  };
  static constexpr std::array<Row, 8> rows{{{8, SAMPLEFORMAT_UINT, SampleType::u8},
                                            {8, SAMPLEFORMAT_INT, SampleType::i8},
                                            {16, SAMPLEFORMAT_UINT, SampleType::u16},
                                            {16, SAMPLEFORMAT_INT, SampleType::i16},
                                            {32, SAMPLEFORMAT_UINT, SampleType::u32},
                                            {32, SAMPLEFORMAT_INT, SampleType::i32},
                                            {32, SAMPLEFORMAT_IEEEFP, SampleType::f32},
                                            {64, SAMPLEFORMAT_IEEEFP, SampleType::f64}}};
  for (const Row& row : rows) {
    if (row.bits == bits && row.format == (format == SAMPLEFORMAT_VOID ? SAMPLEFORMAT_UINT : format))
      return row.type;
  }
  return std::nullopt;
}

/// What is in the image, and whether it is heights.
Result<Layout> read_layout(TiffHandle& handle) {
  TIFF* tiff = handle.tiff();
  const auto unsupported = [&](std::string message) {
    return handle.file().error(ErrorCode::unsupported_version, "first image", std::move(message));
  };
  Layout layout;
  if (!TIFFGetField(tiff, TIFFTAG_IMAGEWIDTH, &layout.width) ||
      !TIFFGetField(tiff, TIFFTAG_IMAGELENGTH, &layout.height) || layout.width == 0 || layout.height == 0)
    return handle.error("first image", "expected a width and a height");
  const std::uint16_t channels = short_field(tiff, TIFFTAG_SAMPLESPERPIXEL, 1);
  if (channels != 1)
    return unsupported(fmt::format("expected one channel of heights, found {}; is it a picture?", channels));
  const std::uint16_t bits = short_field(tiff, TIFFTAG_BITSPERSAMPLE, 1);
  const std::uint16_t format = short_field(tiff, TIFFTAG_SAMPLEFORMAT, SAMPLEFORMAT_UINT);
  const auto type = type_of(bits, format);
  if (!type)
    return unsupported(
        fmt::format("samples of {} bits in format {} are not read; expected integers of 8, 16, 32 "
                    "bits or floats of 32, 64",
                    bits, format));
  layout.type = *type;
  if (const auto colours = short_field(tiff, TIFFTAG_PHOTOMETRIC, PHOTOMETRIC_MINISBLACK);
      colours != PHOTOMETRIC_MINISBLACK && colours != PHOTOMETRIC_MINISWHITE)
    return unsupported(fmt::format("photometric interpretation {} is a picture's, not heights", colours));
  layout.compression = short_field(tiff, TIFFTAG_COMPRESSION, COMPRESSION_NONE);
  if (std::find(compressions.begin(), compressions.end(), layout.compression) == compressions.end() ||
      !TIFFIsCODECConfigured(layout.compression))
    return unsupported(fmt::format("compression {} is not read; write the file with deflate, LZW or zstd",
                                   layout.compression));
  layout.is_tiled = TIFFIsTiled(tiff) != 0;
  return layout;
}

/// The sizes of blocks, checked against each other and the limits.
Result<void> read_blocks(TiffHandle& handle, Layout& layout) {
  TIFF* tiff = handle.tiff();
  if (layout.is_tiled) {
    TIFFGetField(tiff, TIFFTAG_TILEWIDTH, &layout.block_width);
    TIFFGetField(tiff, TIFFTAG_TILELENGTH, &layout.block_height);
  } else {
    layout.block_width = layout.width;
    TIFFGetFieldDefaulted(tiff, TIFFTAG_ROWSPERSTRIP, &layout.block_height);
    layout.block_height = std::min(layout.block_height, layout.height);
  }
  if (layout.block_width == 0 || layout.block_height == 0)
    return handle.error("first image", "expected tiles or strips, found some of size 0");
  const std::uint64_t at_once =
      layout.is_tiled ? layout.block_bytes() : layout.block_width * bytes_of(layout.type);
  if (at_once > largest_block_bytes)
    return handle.file().error(
        ErrorCode::out_of_budget, "first image",
        fmt::format("a {} of {} × {} samples is more than is decoded at once",
                    layout.is_tiled ? "tile" : "strip", layout.block_width, layout.block_height));
  const std::uint64_t across = (layout.width + std::uint64_t{layout.block_width} - 1) / layout.block_width;
  const std::uint64_t down = (layout.height + std::uint64_t{layout.block_height} - 1) / layout.block_height;
  const std::uint64_t there = layout.is_tiled ? TIFFNumberOfTiles(tiff) : TIFFNumberOfStrips(tiff);
  if (there < across * down)
    return handle.error("first image",
                        fmt::format("expected {} tiles or strips, found {}", across * down, there));
  const std::uint64_t decoded = layout.is_tiled ? TIFFTileSize64(tiff) : TIFFStripSize64(tiff);
  if (decoded != layout.block_bytes())
    return handle.error("first image",
                        fmt::format("expected blocks of {} bytes, found {}", layout.block_bytes(), decoded));
  return {};
}

/// `<Item name="…" sample="0" role="scale">0.1</Item>` of GDAL's metadata.
std::optional<double> metadata_item(std::string_view xml, std::string_view role) {
  const std::size_t at = xml.find(fmt::format("role=\"{}\"", role));
  const std::size_t begin = at == xml.npos ? at : xml.find('>', at);
  if (begin == xml.npos) return std::nullopt;
  TextCursor cursor{xml.data() + begin + 1, xml.data() + xml.size()};
  return cursor.real();
}

Result<void> read_meaning(TiffHandle& handle, SampleMeaning& meaning) {
  const std::string_view no_data = handle.text(tiff_tag::gdal_no_data);
  TextCursor cursor{no_data.data(), no_data.data() + no_data.size()};
  cursor.skip_spaces();
  if (!cursor.done()) {
    const auto value = cursor.real();
    if (!value) return handle.error("tag 42113", "expected a no-data value, found " + quote_word(no_data));
    if (!std::isnan(*value)) meaning.no_data = {*value};
  }
  const std::string_view xml = handle.text(tiff_tag::gdal_metadata);
  if (const auto scale = metadata_item(xml, "scale"); scale && std::isfinite(*scale) && *scale != 0)
    meaning.scale = *scale;
  if (const auto offset = metadata_item(xml, "offset"); offset && std::isfinite(*offset))
    meaning.offset = *offset;
  return {};
}

Result<RasterInfo> read_info(TiffHandle& handle, const Layout& layout) {
  RasterInfo info{.width = layout.width, .height = layout.height, .type = layout.type, .format = "GeoTIFF"};
  const auto in_file = [&](Error error) {
    error.file = handle.file().path.string();
    return fail(std::move(error));
  };
  info.files = {handle.file().path.string()};
  if (const auto directory = handle.shorts(tiff_tag::geo_keys); !directory.empty()) {
    auto keys =
        parse_geo_keys(directory, handle.doubles(tiff_tag::geo_doubles), handle.text(tiff_tag::geo_ascii));
    if (!keys) return in_file(std::move(keys).error());
    if (auto r = apply_vertical_keys(*keys, info); !r) return in_file(std::move(r).error());
    info.crs.kind = keys->empty() ? CrsDescription::Kind::unknown : CrsDescription::Kind::geo_keys;
    info.crs.geo_keys = std::move(*keys);
  }
  const auto map = tiff_placement(handle, info.crs.geo_keys);
  if (!map) return fail(map.error());
  info.is_placed = map->has_value();
  info.map = map->value_or(info.map);
  CUESTA_TRY(read_meaning(handle, info.meaning));
  return info;
}

class GeoTiff final : public BlockRaster {
 public:
  GeoTiff(RasterInfo info, const Layout& layout, std::uint64_t cache_bytes,
          std::unique_ptr<TiffHandle> handle)
      : BlockRaster(std::move(info),
                    {layout.type, layout.block_width, layout.block_height, index_bytes(*handle)},
                    cache_bytes),
        layout_(layout),
        handle_(std::move(handle)) {}

 protected:
  Result<void> load_block(std::uint64_t bx, std::uint64_t by, std::span<std::byte> samples) const override {
    TIFF* tiff = handle_->tiff();
    const std::uint64_t across =
        (layout_.width + std::uint64_t{layout_.block_width} - 1) / layout_.block_width;
    const auto number = static_cast<std::uint32_t>(by * across + bx);
    if (TIFFGetStrileByteCount(tiff, number) == 0) {  // GDAL's way to leave empty blocks out
      fill_with_no_data(samples, layout_.type, info_.meaning);
      return {};
    }
    const std::uint64_t rows =
        std::min<std::uint64_t>(layout_.block_height, layout_.height - by * layout_.block_height);
    const std::uint64_t wanted =
        layout_.is_tiled ? samples.size() : rows * layout_.block_width * bytes_of(layout_.type);
    const auto size = static_cast<tmsize_t>(wanted);
    const tmsize_t got = layout_.is_tiled ? TIFFReadEncodedTile(tiff, number, samples.data(), size)
                                          : TIFFReadEncodedStrip(tiff, number, samples.data(), size);
    if (got == size) return {};
    return handle_->error(fmt::format("{} {}", layout_.is_tiled ? "tile" : "strip", number),
                          "cannot be decoded; the file is damaged or cut off");
  }

 private:
  /// libtiff's arrays of offsets and byte counts.
  static std::uint64_t index_bytes(const TiffHandle& handle) {
    TIFF* tiff = handle.tiff();
    return 16 * std::uint64_t{TIFFIsTiled(tiff) ? TIFFNumberOfTiles(tiff) : TIFFNumberOfStrips(tiff)};
  }

  Layout layout_;
  std::unique_ptr<TiffHandle> handle_;
};

/// All rows, in order, into a file without a name.
Result<MappedFile> unpack_rows(TiffHandle& handle, const Layout& layout, const std::filesystem::path& temp) {
  const std::uint64_t row_bytes = layout.width * bytes_of(layout.type);
  if (auto r = check_ratio(handle.file().size(), row_bytes * layout.height, {}); !r)
    return handle.error("first image", "claims more samples than can be in a file of this size");
  auto file = TempFile::create(temp);
  if (!file) return fail(std::move(file).error());
  CUESTA_TRY(file->expect(row_bytes * layout.height));
  std::vector<char> row(row_bytes);
  for (std::uint32_t y = 0; y < layout.height; ++y) {
    if (TIFFReadScanline(handle.tiff(), row.data(), y) != 1)
      return handle.error(fmt::format("row {}", y), "cannot be decoded; the file is damaged or cut off");
    CUESTA_TRY(file->write(row));
  }
  return file->map();
}

}  // namespace

RasterResult open_geotiff(RasterFile file, const RasterOptions& options) {
  auto handle = TiffHandle::open(std::move(file));
  if (!handle) return fail(std::move(handle).error());
  auto layout = read_layout(**handle);
  if (!layout) return fail(layout.error());
  CUESTA_TRY(read_blocks(**handle, *layout));
  auto info = read_info(**handle, *layout);
  if (!info) return fail(info.error());
  info->warnings = (*handle)->warnings();
  if (!options.placement) CUESTA_TRY(read_world_file((*handle)->file(), *info));
  read_prj((*handle)->file(), *info);
  apply_options(*info, options);
  CUESTA_TRY(check_info(*info, (*handle)->file()));
  if (layout->is_tiled || layout->block_bytes() <= largest_strip_bytes)
    return std::make_unique<GeoTiff>(std::move(*info), *layout, options.cache_bytes, std::move(*handle));
  // std::function wants to be copied; the reading itself is under the raster's mutex.
  const std::shared_ptr<TiffHandle> shared = std::move(*handle);
  return make_unpacked_raster(
      std::move(*info),
      [shared, layout = *layout, temp = options.temp] { return unpack_rows(*shared, layout, temp); },
      {.type = layout->type});
}

}  // namespace cuesta
