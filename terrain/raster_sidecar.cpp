#include "terrain/raster_sidecar.h"

#include <fmt/format.h>

#include <array>
#include <map>
#include <nlohmann/json.hpp>

#include "ooc/mapped_file.h"
#include "ooc/read_job.h"

namespace cuesta {
namespace {

using Json = nlohmann::json;
constexpr std::size_t most_bytes = std::size_t{1} << 20;

/// Takes keys of one object; each returns false for a value of a wrong kind.
bool take(const Json& json, std::optional<double>& out) {
  if (!json.is_number()) return false;
  if (!out) out = json.get<double>();
  return true;
}
template <class Unsigned>
bool take_whole(const Json& json, std::optional<Unsigned>& out) {
  if (!json.is_number_unsigned() || json.get<std::uint64_t>() > std::numeric_limits<Unsigned>::max())
    return false;
  if (!out) out = static_cast<Unsigned>(json.get<std::uint64_t>());
  return true;
}
template <class Value, std::size_t N>
bool take_word(const Json& json, const std::array<std::pair<const char*, Value>, N>& words,
               std::optional<Value>& out) {
  for (const auto& [word, value] : words) {
    if (!json.is_string() || json.get_ref<const std::string&>() != word) continue;
    if (!out) out = value;
    return true;
  }
  return false;
}

constexpr std::array<std::pair<const char*, RasterFormat>, 8> formats{
    {{"hgt", RasterFormat::hgt},
     {"geotiff", RasterFormat::geotiff},
     {"ascii-grid", RasterFormat::ascii_grid},
     {"png", RasterFormat::png},
     {"tiles", RasterFormat::tiles},
     {"raw", RasterFormat::raw},
     {"netcdf", RasterFormat::netcdf},
     {"usgs-dem", RasterFormat::usgs_dem}}};
constexpr std::array<std::pair<const char*, SampleType>, 8> types{{{"uint8", SampleType::u8},
                                                                   {"int8", SampleType::i8},
                                                                   {"uint16", SampleType::u16},
                                                                   {"int16", SampleType::i16},
                                                                   {"uint32", SampleType::u32},
                                                                   {"int32", SampleType::i32},
                                                                   {"float32", SampleType::f32},
                                                                   {"float64", SampleType::f64}}};
constexpr std::array<std::pair<const char*, ByteOrder>, 2> orders{
    {{"little", ByteOrder::little}, {"big", ByteOrder::big}}};
constexpr std::array<std::pair<const char*, PixelIs>, 2> pixels{
    {{"area", PixelIs::area}, {"point", PixelIs::point}}};
constexpr std::array<std::pair<const char*, VerticalDatum>, 2> datums{
    {{"orthometric", VerticalDatum::orthometric}, {"ellipsoidal", VerticalDatum::ellipsoidal}}};
constexpr std::array<std::pair<const char*, PngHeights>, 3> png_kinds{
    {{"gray", PngHeights::gray},
     {"terrain-rgb", PngHeights::terrain_rgb},
     {"terrarium", PngHeights::terrarium}}};

bool take_placement(const Json& json, std::optional<Placement>& out) {
  if (!json.is_object()) return false;
  std::optional<double> x, y, x_spacing, y_spacing;
  std::optional<PixelIs> pixel_is;
  for (const auto& [key, value] : json.items()) {
    const bool good = key == "x"           ? take(value, x)
                      : key == "y"         ? take(value, y)
                      : key == "x_spacing" ? take(value, x_spacing)
                      : key == "y_spacing" ? take(value, y_spacing)
                      : key == "pixel_is"  ? take_word(value, pixels, pixel_is)
                                           : false;
    if (!good) return false;
  }
  if (!x || !y || !x_spacing || !y_spacing) return false;
  if (!out) out = Placement{*x, *y, *x_spacing, *y_spacing, pixel_is.value_or(PixelIs::point)};
  return true;
}

bool take_format(const Json& json, RasterFormat& out) {
  std::optional<RasterFormat> format;
  if (out != RasterFormat::detect) format = out;
  if (!take_word(json, formats, format)) return false;
  out = *format;
  return true;
}

bool take_text(const Json& json, std::optional<std::string>& out) {
  if (!json.is_string()) return false;
  if (!out) out = json.get<std::string>();
  return true;
}

enum class Taken : std::uint8_t { good, wrong_value, unknown_key };

Taken take_key(const std::string& key, const Json& value, RasterOptions& o) {
  using Take = bool (*)(const Json&, RasterOptions&);
  static const std::map<std::string, Take, std::less<>> keys{
      {"format", [](const Json& v, RasterOptions& to) { return take_format(v, to.format); }},
      {"placement", [](const Json& v, RasterOptions& to) { return take_placement(v, to.placement); }},
      {"epsg", [](const Json& v, RasterOptions& to) { return take_whole(v, to.epsg); }},
      {"vertical_datum",
       [](const Json& v, RasterOptions& to) { return take_word(v, datums, to.vertical_datum); }},
      {"no_data", [](const Json& v, RasterOptions& to) { return take(v, to.no_data); }},
      {"scale", [](const Json& v, RasterOptions& to) { return take(v, to.scale); }},
      {"offset", [](const Json& v, RasterOptions& to) { return take(v, to.offset); }},
      {"unit_m", [](const Json& v, RasterOptions& to) { return take(v, to.unit_m); }},
      {"type", [](const Json& v, RasterOptions& to) { return take_word(v, types, to.type); }},
      {"byte_order", [](const Json& v, RasterOptions& to) { return take_word(v, orders, to.byte_order); }},
      {"width", [](const Json& v, RasterOptions& to) { return take_whole(v, to.width); }},
      {"height", [](const Json& v, RasterOptions& to) { return take_whole(v, to.height); }},
      {"header_bytes", [](const Json& v, RasterOptions& to) { return take_whole(v, to.header_bytes); }},
      {"png_heights",
       [](const Json& v, RasterOptions& to) { return take_word(v, png_kinds, to.png_heights); }},
      {"zoom", [](const Json& v, RasterOptions& to) { return take_whole(v, to.zoom); }},
      {"variable", [](const Json& v, RasterOptions& to) { return take_text(v, to.variable); }},
  };
  const auto found = keys.find(key);
  if (found == keys.end()) return Taken::unknown_key;
  return found->second(value, o) ? Taken::good : Taken::wrong_value;
}

}  // namespace

std::filesystem::path sidecar_path(const std::filesystem::path& raster) {
  std::error_code ignored;
  if (std::filesystem::is_directory(raster, ignored)) return raster / "raster.json";
  return raster.string() + ".json";
}

Result<void> parse_sidecar(std::string_view text, const std::filesystem::path& path, RasterOptions& options) {
  const Json json = Json::parse(text, nullptr, false);
  if (!json.is_object()) return fail(ErrorCode::corrupt, path.string(), "", "expected one JSON object");
  for (const auto& [key, value] : json.items()) {
    const Taken taken = take_key(key, value, options);
    if (taken == Taken::good) continue;
    return fail(ErrorCode::invalid_input, path.string(), "key " + quote_word(key),
                taken == Taken::unknown_key ? "no such key of a raster's sidecar (terrain/raster_sidecar.h)"
                                            : "not a value that this key can have");
  }
  return {};
}

Result<bool> read_sidecar(const std::filesystem::path& raster, RasterOptions& options) {
  const std::filesystem::path path = sidecar_path(raster);
  std::error_code ignored;
  if (!std::filesystem::is_regular_file(path, ignored)) return false;
  const auto file = MappedFile::open(path);
  if (!file) return fail(file.error());
  if (file->bytes().size() > most_bytes)
    return fail(ErrorCode::corrupt, path.string(), "", "expected at most 1 MiB of JSON");
  CUESTA_TRY(parse_sidecar({file->bytes().data(), file->bytes().size()}, path, options));
  CUESTA_TRY(file->check_unchanged());
  return true;
}

}  // namespace cuesta
