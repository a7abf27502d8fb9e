#include "terrain/tiff_handle.h"

#include <tiffio.h>

#include <algorithm>
#include <array>
#include <cstdio>
#include <mutex>

namespace cuesta {
namespace {

TIFFExtendProc next_extender = nullptr;

// Each has its type, so that libtiff converts, or refuses, what a file has in its place.
TIFFFieldInfo field(std::uint32_t tag, TIFFDataType type, const char* name) {
  const bool is_text = type == TIFF_ASCII;
  const short count = is_text ? TIFF_VARIABLE : TIFF_VARIABLE2;
  return {tag,
          count,
          count,
          type,
          FIELD_CUSTOM,
          1,
          static_cast<unsigned char>(is_text ? 0 : 1),
          const_cast<char*>(name)};
}

void add_fields(TIFF* tiff) {
  static const std::array<TIFFFieldInfo, 8> fields{
      {field(tiff_tag::pixel_scale, TIFF_DOUBLE, "ModelPixelScale"),
       field(tiff_tag::tie_points, TIFF_DOUBLE, "ModelTiepoint"),
       field(tiff_tag::transformation, TIFF_DOUBLE, "ModelTransformation"),
       field(tiff_tag::geo_keys, TIFF_SHORT, "GeoKeyDirectory"),
       field(tiff_tag::geo_doubles, TIFF_DOUBLE, "GeoDoubleParams"),
       field(tiff_tag::geo_ascii, TIFF_ASCII, "GeoAsciiParams"),
       field(tiff_tag::gdal_metadata, TIFF_ASCII, "GDAL_METADATA"),
       field(tiff_tag::gdal_no_data, TIFF_ASCII, "GDAL_NODATA")}};
  TIFFMergeFieldInfo(tiff, fields.data(), fields.size());
  if (next_extender) next_extender(tiff);
}

std::string format_message(const char* module, const char* format, va_list arguments) {
  std::array<char, 512> text{};
  std::vsnprintf(text.data(), text.size(), format, arguments);
  return module && *module ? std::string(module) + ": " + text.data() : std::string(text.data());
}

}  // namespace

void register_geotiff_tags() {
  static std::once_flag once;
  std::call_once(once, [] { next_extender = TIFFSetTagExtender(add_fields); });
}

struct TiffHandle::Calls {
  static TiffHandle& self(thandle_t handle) { return *static_cast<TiffHandle*>(handle); }

  static tmsize_t read(thandle_t handle, void* into, tmsize_t count) {
    TiffHandle& h = self(handle);
    if (count <= 0 || h.position_ >= h.file_.size()) return 0;
    const std::uint64_t bytes =
        std::min<std::uint64_t>(static_cast<std::uint64_t>(count), h.file_.size() - h.position_);
    if (!h.file_.read(h.position_, {static_cast<std::byte*>(into), bytes})) return -1;
    h.position_ += bytes;
    return static_cast<tmsize_t>(bytes);
  }
  static tmsize_t write(thandle_t, void*, tmsize_t) { return 0; }
  static toff_t seek(thandle_t handle, toff_t offset, int from) {
    TiffHandle& h = self(handle);
    h.position_ = (from == SEEK_CUR ? h.position_ : from == SEEK_END ? h.file_.size() : 0) + offset;
    return h.position_;
  }
  static int close(thandle_t) { return 0; }
  static toff_t size(thandle_t handle) { return self(handle).file_.size(); }

  static int error(TIFF*, void* user, const char* module, const char* format, va_list arguments) {
    TiffHandle& h = *static_cast<TiffHandle*>(user);
    if (h.said_.empty()) h.said_ = format_message(module, format, arguments);
    return 1;
  }
  static int warning(TIFF*, void* user, const char* module, const char* format, va_list arguments) {
    TiffHandle& h = *static_cast<TiffHandle*>(user);
    if (h.warnings_.size() >= 8) return 1;
    std::string text = format_message(module, format, arguments);
    if (std::find(h.warnings_.begin(), h.warnings_.end(), text) == h.warnings_.end())
      h.warnings_.push_back(std::move(text));
    return 1;
  }
};

Result<std::unique_ptr<TiffHandle>> TiffHandle::open(RasterFile file) {
  register_geotiff_tags();
  std::unique_ptr<TiffHandle> handle(new TiffHandle(std::move(file)));
  TIFFOpenOptions* options = TIFFOpenOptionsAlloc();
  TIFFOpenOptionsSetMaxSingleMemAlloc(options, static_cast<tmsize_t>(most_alloc_bytes));
  TIFFOpenOptionsSetErrorHandlerExtR(options, Calls::error, handle.get());
  TIFFOpenOptionsSetWarningHandlerExtR(options, Calls::warning, handle.get());
  handle->tiff_ = TIFFClientOpenExt("TIFF", "rm", handle.get(), Calls::read, Calls::write, Calls::seek,
                                    Calls::close, Calls::size, nullptr, nullptr, options);
  TIFFOpenOptionsFree(options);
  if (!handle->tiff_) return handle->error("", "not a TIFF that can be read");
  return handle;
}

TiffHandle::~TiffHandle() {
  if (tiff_) TIFFClose(tiff_);
}

tl::unexpected<Error> TiffHandle::error(std::string place, std::string message) {
  if (!said_.empty()) message += " (libtiff: " + std::exchange(said_, {}) + ")";
  return file_.error(ErrorCode::corrupt, std::move(place), std::move(message));
}

std::span<const std::uint16_t> TiffHandle::shorts(std::uint32_t tag) const {
  std::uint32_t count = 0;
  const std::uint16_t* values = nullptr;
  if (!TIFFGetField(tiff_, tag, &count, &values) || !values) return {};
  return {values, count};
}

std::span<const double> TiffHandle::doubles(std::uint32_t tag) const {
  std::uint32_t count = 0;
  const double* values = nullptr;
  if (!TIFFGetField(tiff_, tag, &count, &values) || !values) return {};
  return {values, count};
}

std::string_view TiffHandle::text(std::uint32_t tag) const {
  const char* value = nullptr;
  if (!TIFFGetField(tiff_, tag, &value) || !value) return {};
  return value;
}

}  // namespace cuesta
