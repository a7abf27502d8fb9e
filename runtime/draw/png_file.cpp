#include "runtime/draw/png_file.h"

#include <png.h>

#include <cstring>
#include <fstream>
#include <span>

#include "ooc/atomic_file.h"
#include "ooc/check.h"

namespace cuesta {
namespace {

constexpr std::uint64_t max_pixels = std::uint64_t{1} << 28;
constexpr std::uint64_t max_file_bytes = std::uint64_t{1} << 31;

using Bytes = std::vector<std::uint8_t>;

/// libpng's simplified interface: no longjmp through our frames, and freed on every path.
struct PngImage {
  png_image image{};

  PngImage() { image.version = PNG_IMAGE_VERSION; }
  PngImage(const PngImage&) = delete;
  PngImage& operator=(const PngImage&) = delete;
  ~PngImage() { png_image_free(&image); }
};

Result<Bytes> read_bytes(const std::filesystem::path& path) {
  std::ifstream file(path, std::ios::binary | std::ios::ate);
  std::error_code ignored;
  if (!file) {
    const bool exists = std::filesystem::exists(path, ignored);
    return fail(exists ? ErrorCode::io : ErrorCode::not_found, path.string(), "", "cannot open the picture");
  }
  const std::streamoff size = file.tellg();
  if (size < 0) return fail(ErrorCode::io, path.string(), "", "cannot tell the size of the picture");
  if (static_cast<std::uint64_t>(size) > max_file_bytes)
    return fail(ErrorCode::out_of_budget, path.string(), "", "the file is larger than 2 GiB");
  Bytes bytes(static_cast<std::size_t>(size));
  file.seekg(0);
  if (!file.read(reinterpret_cast<char*>(bytes.data()), size))
    return fail(ErrorCode::io, path.string(), "", "cannot read the picture");
  return bytes;
}

std::uint32_t big_endian_32(const std::uint8_t* p) {
  return std::uint32_t{p[0]} << 24 | std::uint32_t{p[1]} << 16 | std::uint32_t{p[2]} << 8 | p[3];
}

/// libpng stops at the last row; a file cut after that would pass. True if the chunks run up to a whole IEND.
bool has_end_chunk(const Bytes& bytes) {
  std::size_t at = 8;
  while (bytes.size() >= at + 12) {
    const std::size_t end = at + 12 + big_endian_32(&bytes[at]);
    if (end > bytes.size()) return false;
    if (std::memcmp(&bytes[at + 4], "IEND", 4) == 0) return true;
    at = end;
  }
  return false;
}

}  // namespace

Result<std::string> encode_png(const Picture& picture) {
  CUESTA_CHECK(picture.width_px > 0 && picture.height_px > 0, picture.width_px, picture.height_px);
  CUESTA_CHECK(picture.pixels.size() ==
               static_cast<std::size_t>(picture.width_px) * static_cast<std::size_t>(picture.height_px));
  PngImage png;
  png.image.width = static_cast<png_uint_32>(picture.width_px);
  png.image.height = static_cast<png_uint_32>(picture.height_px);
  png.image.format = PNG_FORMAT_RGBA;  // 8-bit formats get an sRGB chunk
  png_alloc_size_t size = PNG_IMAGE_PNG_SIZE_MAX(png.image);
  std::string bytes(size, '\0');
  if (!png_image_write_to_memory(&png.image, bytes.data(), &size, 0, picture.pixels.data(), 0, nullptr))
    return fail(ErrorCode::io, "", "", std::string("cannot encode the picture: ") + png.image.message);
  bytes.resize(size);
  return bytes;
}

Result<void> write_png(const std::filesystem::path& path, const Picture& picture) {
  auto bytes = encode_png(picture);
  if (!bytes) {
    bytes.error().file = path.string();
    return fail(bytes.error());
  }
  auto file = AtomicFile::create(path);
  if (!file) return fail(file.error());
  if (auto written = file->write(std::as_bytes(std::span(*bytes))); !written) return written;
  return file->commit();
}

Result<Picture> read_png(const std::filesystem::path& path) {
  const auto bytes = read_bytes(path);
  if (!bytes) return fail(bytes.error());
  PngImage png;
  const auto corrupt = [&](const char* what) { return fail(ErrorCode::corrupt, path.string(), "", what); };
  if (!png_image_begin_read_from_memory(&png.image, bytes->data(), bytes->size()))
    return corrupt(png.image.message);
  const std::uint64_t count = std::uint64_t{png.image.width} * png.image.height;
  if (count > max_pixels)
    return fail(ErrorCode::out_of_budget, path.string(), "", "the picture has more than 2^28 pixels");
  if (!has_end_chunk(*bytes)) return corrupt("expected an IEND chunk, found the end of the file");
  png.image.format = PNG_FORMAT_RGBA;
  Picture picture{static_cast<int>(png.image.width), static_cast<int>(png.image.height), {}};
  picture.pixels.resize(count);
  if (!png_image_finish_read(&png.image, nullptr, picture.pixels.data(), 0, nullptr))
    return corrupt(png.image.message);
  return picture;
}

}  // namespace cuesta
