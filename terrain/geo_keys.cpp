#include "terrain/geo_keys.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>

namespace cuesta {
namespace {

constexpr std::uint16_t double_params_tag = 34736, ascii_params_tag = 34737;

tl::unexpected<Error> corrupt(std::string message) {
  return fail(ErrorCode::corrupt, "", "GeoKeys", std::move(message));
}

Result<GeoKey> parse_key(std::span<const std::uint16_t> entry, std::span<const double> doubles,
                         std::string_view ascii) {
  const std::uint16_t id = entry[0], tag = entry[1];
  const std::size_t count = entry[2], at = entry[3];
  if (tag == 0) return GeoKey{id, entry[3]};
  const bool is_double = tag == double_params_tag;
  if (!is_double && tag != ascii_params_tag)
    return corrupt(fmt::format("key {} has its value in tag {}, expected 34736 or 34737", id, tag));
  const std::size_t there = is_double ? doubles.size() : ascii.size();
  if (at > there || count > there - at)
    return corrupt(fmt::format("key {} wants {} values from {} on, there are {}", id, count, at, there));
  if (is_double)
    return GeoKey{id, std::vector<double>(doubles.begin() + long(at), doubles.begin() + long(at + count))};
  std::string text(ascii.substr(at, count));
  while (!text.empty() && (text.back() == '|' || text.back() == '\0')) text.pop_back();
  return GeoKey{id, std::move(text)};
}

struct VerticalUnit {
  std::uint16_t epsg;
  double metres;
};
constexpr std::array<VerticalUnit, 5> units{
    {{9001, 1.0}, {9002, 0.3048}, {9003, 1200.0 / 3937.0}, {9036, 1000.0}, {1025, 0.001}}};

/// GeoTIFF 1.0 numbered heights above an ellipsoid 5001 to 5033, 5030 being that of WGS 84.
bool is_ellipsoidal(std::uint16_t code) {
  return code >= 5001 && code <= 5033;
}

std::string name_of_vertical(std::uint16_t code) {
  switch (code) {
    case 3855:
      return "EGM2008";
    case 5773:
      return "EGM96";
    case 5798:
      return "EGM84";
    case 5703:
      return "NAVD88";
    default:
      return fmt::format("EPSG {}", code);
  }
}

}  // namespace

Result<std::vector<GeoKey>> parse_geo_keys(std::span<const std::uint16_t> directory,
                                           std::span<const double> doubles, std::string_view ascii) {
  if (directory.size() < 4)
    return corrupt(fmt::format("expected at least 4 numbers, found {}", directory.size()));
  const std::size_t count = directory[3];
  if (directory[0] != 1) return corrupt(fmt::format("expected version 1, found {}", directory[0]));
  if (directory.size() / 4 - 1 < count)
    return corrupt(fmt::format("expected {} keys, found {}", count, directory.size() / 4 - 1));
  std::vector<GeoKey> keys;
  for (std::size_t k = 1; k <= count; ++k) {
    auto key = parse_key(directory.subspan(4 * k, 4), doubles, ascii);
    if (!key) return fail(std::move(key).error());
    keys.push_back(std::move(*key));
  }
  const auto by_id = [](const GeoKey& a, const GeoKey& b) { return a.id < b.id; };
  std::stable_sort(keys.begin(), keys.end(), by_id);
  keys.erase(
      std::unique(keys.begin(), keys.end(), [](const GeoKey& a, const GeoKey& b) { return a.id == b.id; }),
      keys.end());
  return keys;
}

const GeoKey* find_key(std::span<const GeoKey> keys, std::uint16_t id) {
  for (const GeoKey& key : keys) {
    if (key.id == id) return &key;
  }
  return nullptr;
}

std::optional<std::uint16_t> short_key(std::span<const GeoKey> keys, std::uint16_t id) {
  const GeoKey* key = find_key(keys, id);
  const auto* value = key ? std::get_if<std::uint16_t>(&key->value) : nullptr;
  return value ? std::optional(*value) : std::nullopt;
}

Result<void> apply_vertical_keys(std::span<const GeoKey> keys, RasterInfo& info) {
  const std::uint16_t crs = short_key(keys, geo_key::vertical_crs).value_or(0);
  if (is_ellipsoidal(crs)) {
    info.vertical_datum = VerticalDatum::ellipsoidal;
    info.vertical_name = fmt::format("ellipsoid {}", crs);
  } else if (crs != 0 && crs != 32767) {
    info.vertical_datum = VerticalDatum::orthometric;
    info.vertical_name = name_of_vertical(crs);
  } else if (short_key(keys, geo_key::geodetic_crs) == 4979) {  // WGS 84 with three coordinates
    info.vertical_datum = VerticalDatum::ellipsoidal;
    info.vertical_name = "WGS 84";
  } else if (const GeoKey* citation = find_key(keys, geo_key::vertical_citation)) {
    if (const auto* text = std::get_if<std::string>(&citation->value)) info.vertical_name = *text;
  }
  const auto unit = short_key(keys, geo_key::vertical_units);
  if (!unit || *unit == 0) return {};
  for (const VerticalUnit& known : units) {
    if (known.epsg != *unit) continue;
    info.meaning.unit_m = known.metres;
    return {};
  }
  return fail(ErrorCode::unsupported_version, "", "GeoKey 4099",
              fmt::format("vertical unit EPSG {} is not known; give its metres as unit_m", *unit));
}

}  // namespace cuesta
