#include "terrain/image_pixels.h"

#include <fmt/format.h>
#include <tiffio.h>

#include <cstring>
#include <vector>

#include "ooc/read_job.h"
#include "ooc/temp_file.h"
#include "terrain/crs_geokeys.h"
#include "terrain/geo_keys.h"
#include "terrain/jpeg_image.h"
#include "terrain/png_image.h"
#include "terrain/tiff_handle.h"
#include "terrain/tiff_placement.h"

namespace cuesta {
namespace {

constexpr std::uint32_t most_pixels_across = std::uint32_t{1} << 24;
constexpr std::uint32_t unpacked_block = 256;

Result<void> check_size(const RasterFile& file, std::uint32_t width, std::uint32_t height) {
  if (width > 0 && height > 0 && width <= most_pixels_across && height <= most_pixels_across) return {};
  return file.error(ErrorCode::unsupported_version, "head",
                    fmt::format("expected 1 to 2^24 pixels across and down, found {} × {}", width, height));
}

/// Colours row by row in a temporary file.
class UnpackedPixels final : public ImagePixels {
 public:
  UnpackedPixels(std::uint32_t w, std::uint32_t h, TempFile colours) : colours_(std::move(colours)) {
    width = w;
    height = h;
    block_width = std::min(unpacked_block, width);
    block_height = std::min(unpacked_block, height);
  }
  Result<void> load(std::uint32_t bx, std::uint32_t by, std::span<Rgba8> colours) override {
    const std::uint32_t left = bx * block_width, top = by * block_height;
    const std::uint32_t across = std::min(block_width, width - left);
    for (std::uint32_t y = 0; y < block_height && top + y < height; ++y) {
      const std::span row = colours.subspan(std::size_t{y} * block_width, across);
      const std::uint64_t first = std::uint64_t{top + y} * width + left;
      CUESTA_TRY(colours_.read(first * sizeof(Rgba8),
                               {reinterpret_cast<char*>(row.data()), row.size() * sizeof(Rgba8)}));
    }
    return {};
  }

 private:
  TempFile colours_;
};

/// Where the rows of a decoder go.
Result<TempFile> room_for(const RasterFile& file, std::uint32_t width, std::uint32_t height,
                          const std::filesystem::path& temp) {
  CUESTA_TRY(check_size(file, width, height));
  auto colours = TempFile::create(temp);
  if (!colours) return colours;
  CUESTA_TRY(colours->expect(std::uint64_t{width} * height * sizeof(Rgba8)));
  return colours;
}

Result<std::unique_ptr<ImagePixels>> unpack_jpeg(const RasterFile& file, const std::filesystem::path& temp) {
  const auto size = read_jpeg_head(file);
  if (!size) return fail(size.error());
  auto colours = room_for(file, size->width, size->height, temp);
  if (!colours) return fail(colours.error());
  CUESTA_TRY(decode_jpeg(file, [&](std::span<const Rgba8> row) {
    return colours->write({reinterpret_cast<const char*>(row.data()), row.size_bytes()});
  }));
  return std::make_unique<UnpackedPixels>(size->width, size->height, std::move(*colours));
}

/// Samples as the decoder of terrain-RGB gives them: 65536 R + 256 G + B.
Rgba8 colour_of(std::uint32_t sample) {
  if (sample == transparent_sample) return {0, 0, 0, 0};
  return {static_cast<std::uint8_t>(sample >> 16), static_cast<std::uint8_t>(sample >> 8 & 0xFFu),
          static_cast<std::uint8_t>(sample & 0xFFu), 255};
}

Result<std::unique_ptr<ImagePixels>> unpack_png(const RasterFile& file, const std::filesystem::path& temp) {
  const auto head = read_png_head(file, PngHeights::terrain_rgb);
  if (!head) return fail(head.error());
  auto colours = room_for(file, head->width, head->height, temp);
  if (!colours) return fail(colours.error());
  std::vector<Rgba8> row(head->width);
  CUESTA_TRY(decode_png(file, PngHeights::terrain_rgb, [&](std::span<const std::byte> samples) {
    for (std::size_t x = 0; x < row.size(); ++x) {
      std::uint32_t sample = 0;
      std::memcpy(&sample, samples.data() + 4 * x, 4);
      row[x] = colour_of(sample);
    }
    return colours->write({reinterpret_cast<const char*>(row.data()), row.size() * sizeof(Rgba8)});
  }));
  return std::make_unique<UnpackedPixels>(head->width, head->height, std::move(*colours));
}

class TiffPixels final : public ImagePixels {
 public:
  static Result<std::unique_ptr<ImagePixels>> open(RasterFile file) {
    auto handle = TiffHandle::open(std::move(file));
    if (!handle) return fail(handle.error());
    std::unique_ptr<TiffPixels> pixels(new TiffPixels(std::move(*handle)));
    CUESTA_TRY(pixels->read_layout());
    CUESTA_TRY(pixels->read_place());
    return std::unique_ptr<ImagePixels>(std::move(pixels));
  }

  Result<void> load(std::uint32_t bx, std::uint32_t by, std::span<Rgba8> colours) override {
    const std::uint32_t left = bx * block_width, top = by * block_height;
    // A strip at the end has its own rows only.
    const std::uint32_t rows = is_tiled_ ? block_height : std::min(block_height, height - top);
    const bool good = is_plain_ ? load_plain(left, top, rows, colours) : load_any(left, top, rows, colours);
    if (good) return {};
    return handle_->error(fmt::format("{} at {}, {}", is_tiled_ ? "tile" : "strip", left, top),
                          "cannot be decoded; the file is damaged or cut off");
  }

 private:
  explicit TiffPixels(std::unique_ptr<TiffHandle> handle) : handle_(std::move(handle)) {}

  /// Whatever libtiff can make colours of; the last row comes first.
  bool load_any(std::uint32_t left, std::uint32_t top, std::uint32_t rows, std::span<Rgba8> colours) {
    packed_.resize(colours.size());
    TIFF* tiff = handle_->tiff();
    const bool good = is_tiled_ ? TIFFReadRGBATileExt(tiff, left, top, packed_.data(), 1) != 0
                                : TIFFReadRGBAStripExt(tiff, top, packed_.data(), 1) != 0;
    for (std::uint32_t y = 0; y < rows; ++y)
      for (std::uint32_t x = 0; x < block_width; ++x) {
        const std::uint32_t c = packed_[std::size_t{rows - 1 - y} * block_width + x];
        colours[std::size_t{y} * block_width + x] = {
            static_cast<std::uint8_t>(TIFFGetR(c)), static_cast<std::uint8_t>(TIFFGetG(c)),
            static_cast<std::uint8_t>(TIFFGetB(c)), static_cast<std::uint8_t>(TIFFGetA(c))};
      }
    return good;
  }

  /// Bytes of one plane: libtiff 4.5 makes no colours of tiles without compression at the right edge.
  bool load_plain(std::uint32_t left, std::uint32_t top, std::uint32_t rows, std::span<Rgba8> colours) {
    TIFF* tiff = handle_->tiff();
    bytes_.resize(colours.size() * channels_);
    const auto size = static_cast<tmsize_t>(std::size_t{block_width} * rows * channels_);
    const tmsize_t got =
        is_tiled_ ? TIFFReadEncodedTile(tiff, TIFFComputeTile(tiff, left, top, 0, 0), bytes_.data(), size)
                  : TIFFReadEncodedStrip(tiff, TIFFComputeStrip(tiff, top, 0), bytes_.data(), size);
    if (got != size) return false;
    for (std::size_t i = 0; i < std::size_t{block_width} * rows; ++i)
      colours[i] = plain_colour(std::span(bytes_).subspan(i * channels_, channels_));
    return true;
  }
  Rgba8 plain_colour(std::span<const std::uint8_t> p) const {
    const bool is_gray = channels_ < 3;
    const std::uint8_t alpha = has_alpha_ ? p[is_gray ? 1 : 3] : std::uint8_t{255};
    const auto channel = [&](std::size_t c) {
      const unsigned value = p[is_gray ? 0 : c];
      return static_cast<std::uint8_t>(is_multiplied_ ? value : (value * alpha + 127) / 255);
    };
    return {channel(0), channel(1), channel(2), alpha};
  }

  /// Gray or colours of 8 bits, side by side.
  void look_for_plain() {
    TIFF* tiff = handle_->tiff();
    std::uint16_t bits = 0, planes = 0, colours = 0, compression = 0, extra_count = 0;
    const std::uint16_t* extra = nullptr;
    TIFFGetFieldDefaulted(tiff, TIFFTAG_BITSPERSAMPLE, &bits);
    TIFFGetFieldDefaulted(tiff, TIFFTAG_SAMPLESPERPIXEL, &channels_);
    TIFFGetFieldDefaulted(tiff, TIFFTAG_PLANARCONFIG, &planes);
    TIFFGetField(tiff, TIFFTAG_PHOTOMETRIC, &colours);
    TIFFGetFieldDefaulted(tiff, TIFFTAG_COMPRESSION, &compression);
    TIFFGetFieldDefaulted(tiff, TIFFTAG_EXTRASAMPLES, &extra_count, &extra);
    const bool is_gray = colours == PHOTOMETRIC_MINISBLACK && (channels_ == 1 || channels_ == 2);
    const bool is_rgb = colours == PHOTOMETRIC_RGB && (channels_ == 3 || channels_ == 4);
    const std::uint64_t bytes = is_tiled_ ? TIFFTileSize64(tiff) : TIFFStripSize64(tiff);
    is_plain_ = bits == 8 && planes == PLANARCONFIG_CONTIG && (is_gray || is_rgb) &&
                compression != COMPRESSION_JPEG &&
                bytes == std::uint64_t{block_width} * block_height * channels_;
    has_alpha_ = extra_count == 1 && extra[0] != EXTRASAMPLE_UNSPECIFIED;
    is_multiplied_ = !has_alpha_ || extra[0] == EXTRASAMPLE_ASSOCALPHA;
  }

  Result<void> read_layout() {
    TIFF* tiff = handle_->tiff();
    TIFFGetField(tiff, TIFFTAG_IMAGEWIDTH, &width);
    TIFFGetField(tiff, TIFFTAG_IMAGELENGTH, &height);
    CUESTA_TRY(check_size(handle_->file(), width, height));
    is_tiled_ = TIFFIsTiled(tiff) != 0;
    if (is_tiled_) {
      TIFFGetField(tiff, TIFFTAG_TILEWIDTH, &block_width);
      TIFFGetField(tiff, TIFFTAG_TILELENGTH, &block_height);
    } else {
      block_width = width;
      TIFFGetFieldDefaulted(tiff, TIFFTAG_ROWSPERSTRIP, &block_height);
      block_height = std::min(block_height, height);
    }
    if (block_width == 0 || block_height == 0)
      return handle_->error("first image", "expected tiles or strips, found some of size 0");
    if (std::uint64_t{block_width} * block_height * sizeof(Rgba8) > largest_block_bytes)
      return handle_->file().error(
          ErrorCode::unsupported_version, "first image",
          fmt::format("a {} of {} × {} pixels is more than is decoded at once; write the file in tiles",
                      is_tiled_ ? "tile" : "strip", block_width, block_height));
    look_for_plain();
    if (is_plain_) return {};
    char why[1024] = "";
    if (TIFFRGBAImageOK(tiff, why)) return {};
    return handle_->file().error(ErrorCode::unsupported_version, "first image",
                                 std::string("is no picture that can be read: ") + why);
  }

  /// Nothing where the tags do not place the picture.
  Result<void> read_place() {
    const auto in_file = [&](Error error) {
      error.file = handle_->file().path.string();
      return fail(std::move(error));
    };
    const auto directory = handle_->shorts(tiff_tag::geo_keys);
    if (directory.empty()) return {};
    CrsDescription description;
    auto keys = parse_geo_keys(directory, handle_->doubles(tiff_tag::geo_doubles),
                               handle_->text(tiff_tag::geo_ascii));
    if (!keys) return in_file(keys.error());
    const auto map = tiff_placement(*handle_, *keys);
    if (!map) return fail(map.error());
    if (!*map) return {};
    description.kind = CrsDescription::Kind::geo_keys;
    description.geo_keys = std::move(*keys);
    auto crs = crs_of(description);
    if (!crs) return in_file(crs.error());
    place.emplace(PicturePlace{**map, std::move(*crs)});
    return {};
  }

  std::unique_ptr<TiffHandle> handle_;
  bool is_tiled_ = false, is_plain_ = false, has_alpha_ = false, is_multiplied_ = true;
  std::uint16_t channels_ = 1;
  std::vector<std::uint32_t> packed_;  // of load_any()
  std::vector<std::uint8_t> bytes_;    // of load_plain()
};

}  // namespace

Result<std::unique_ptr<ImagePixels>> open_image(RasterFile file, const std::filesystem::path& temp) {
  using namespace std::string_view_literals;
  if (file.begins_with("\xFF\xD8\xFF"sv)) return unpack_jpeg(file, temp);
  if (file.begins_with("\x89PNG\r\n\x1A\n"sv)) return unpack_png(file, temp);
  for (const auto magic : {"II*\0"sv, "MM\0*"sv, "II+\0"sv, "MM\0+"sv})
    if (file.begins_with(magic)) return TiffPixels::open(std::move(file));
  return file.error(ErrorCode::unsupported_version, "first bytes", "expected a picture: JPEG, PNG or TIFF");
}

}  // namespace cuesta
