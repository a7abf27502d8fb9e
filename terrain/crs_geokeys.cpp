#include "terrain/crs_geokeys.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <initializer_list>
#include <numbers>
#include <optional>

#include "terrain/crs_datum.h"
#include "terrain/crs_epsg.h"
#include "terrain/crs_wkt.h"

namespace cuesta {
namespace {

constexpr int user_defined = 32767;

enum Key : std::uint16_t {
  model_type = 1024,
  citation = 1026,
  geographic_type = 2048,
  geog_citation = 2049,
  geog_datum = 2050,
  geog_prime_meridian = 2051,
  geog_angular_unit = 2054,
  geog_angular_unit_size = 2055,
  geog_ellipsoid = 2056,
  geog_semi_major = 2057,
  geog_semi_minor = 2058,
  geog_inverse_flattening = 2059,
  geog_prime_meridian_long = 2061,
  geog_to_wgs84 = 2062,
  projected_type = 3072,
  projected_citation = 3073,
  projection = 3074,
  proj_method = 3075,
  proj_unit = 3076,
  proj_unit_size = 3077,
  std_parallel_1 = 3078,
  std_parallel_2 = 3079,
  nat_origin_long = 3080,
  nat_origin_lat = 3081,
  false_easting = 3082,
  false_northing = 3083,
  false_origin_long = 3084,
  false_origin_lat = 3085,
  false_origin_easting = 3086,
  false_origin_northing = 3087,
  center_long = 3088,
  center_lat = 3089,
  center_easting = 3090,
  center_northing = 3091,
  scale_at_nat_origin = 3092,
  scale_at_center = 3093,
  straight_vert_pole_long = 3095,
};

constexpr const char* method_names[] = {
    "",  // codes of key 3075 begin at 1
    "transverse Mercator",
    "modified Alaska transverse Mercator",
    "oblique Mercator",
    "Laborde oblique Mercator",
    "Rosenmund oblique Mercator",
    "spherical oblique Mercator",
    "Mercator",
    "Lambert conformal conic (2SP)",
    "Lambert conformal conic (1SP)",
    "Lambert azimuthal equal area",
    "Albers equal area",
    "azimuthal equidistant",
    "equidistant conic",
    "stereographic",
    "polar stereographic",
    "oblique stereographic",
    "equirectangular",
    "Cassini-Soldner",
    "gnomonic",
    "Miller cylindrical",
    "orthographic",
    "polyconic",
    "Robinson",
    "sinusoidal",
    "Van der Grinten",
    "New Zealand map grid",
    "south-oriented transverse Mercator",
    "cylindrical equal area",
};

tl::unexpected<Error> key_fault(int key, ErrorCode code, std::string message) {
  return fail(code, "", fmt::format("GeoKey {}", key), std::move(message));
}

/// Typed access; remembers the first key that has the wrong type, since no parameter must be ignored.
class KeyReader {
 public:
  explicit KeyReader(std::span<const GeoKey> keys) : keys_(keys) {}

  std::optional<int> code(Key key) {
    const GeoKey* found = find(key);
    if (!found) return std::nullopt;
    if (const auto* value = std::get_if<std::uint16_t>(&found->value)) return *value;
    wrong_ = key;
    return std::nullopt;
  }
  std::optional<double> number(Key key) {
    const GeoKey* found = find(key);
    if (!found) return std::nullopt;
    if (const auto* value = std::get_if<std::vector<double>>(&found->value); value && value->size() == 1) {
      return value->front();
    }
    if (const auto* value = std::get_if<std::uint16_t>(&found->value)) return *value;
    wrong_ = key;
    return std::nullopt;
  }
  /// The first of several keys that is there.
  std::optional<double> number(std::initializer_list<Key> keys) {
    for (const Key key : keys) {
      if (const auto value = number(key)) return value;
    }
    return std::nullopt;
  }
  std::string text(std::initializer_list<Key> keys) {
    for (const Key key : keys) {
      const GeoKey* found = find(key);
      const auto* value = found ? std::get_if<std::string>(&found->value) : nullptr;
      if (value && !value->empty()) return *value;
    }
    return "";
  }
  std::span<const double> numbers(Key key) {
    const GeoKey* found = find(key);
    const auto* value = found ? std::get_if<std::vector<double>>(&found->value) : nullptr;
    return value ? std::span<const double>(*value) : std::span<const double>();
  }
  std::optional<Key> wrong() const { return wrong_; }

 private:
  const GeoKey* find(Key key) const {
    const auto found = std::ranges::find(keys_, static_cast<std::uint16_t>(key), &GeoKey::id);
    return found == keys_.end() ? nullptr : &*found;
  }

  std::span<const GeoKey> keys_;
  std::optional<Key> wrong_;
};

/// Metres of a unit: the EPSG code in key `unit_key`, or a size of the user's own.
Result<std::optional<double>> linear_unit(KeyReader& keys) {
  const std::optional<int> code = keys.code(proj_unit);
  if (!code) return std::optional<double>();
  switch (*code) {
    case 9001:
      return std::optional(1.0);
    case 9002:
      return std::optional(foot_m);
    case 9003:
      return std::optional(us_survey_foot_m);
    case 9005:
      return std::optional(0.3047972654);  // Clarke's foot
    case 9036:
      return std::optional(1000.0);
    case 9037:
      return std::optional(0.9143917962);  // Clarke's yard
    case 9040:
      return std::optional(0.9143984146160287);  // Sears's yard
    case 9041:
      return std::optional(0.3047994715386762);  // Sears's foot
    case 9084:
      return std::optional(0.9143985307444408);  // Indian yard
    case 9096:
      return std::optional(0.9144);
    case user_defined:
      if (const auto size = keys.number(proj_unit_size)) return std::optional(*size);
      return key_fault(proj_unit_size, ErrorCode::not_found, "the size of the linear unit is missing");
    default:
      return key_fault(proj_unit, ErrorCode::unsupported_version,
                       fmt::format("unit of length EPSG:{} is not supported", *code));
  }
}

Result<double> angular_unit_deg(KeyReader& keys) {
  constexpr double radian_deg = 180 / std::numbers::pi;
  const int code = keys.code(geog_angular_unit).value_or(9102);
  switch (code) {
    case 9101:
      return radian_deg;
    case 9102:
    case 9122:
      return 1.0;
    case 9103:
      return 1.0 / 60;
    case 9104:
      return 1.0 / 3600;
    case 9105:
    case 9106:
      return 0.9;
    case user_defined:
      if (const auto size_rad = keys.number(geog_angular_unit_size)) return *size_rad * radian_deg;
      return key_fault(geog_angular_unit_size, ErrorCode::not_found,
                       "the size of the angular unit is missing");
    default:
      return key_fault(geog_angular_unit, ErrorCode::unsupported_version,
                       fmt::format("angular unit EPSG:{} is not supported", code));
  }
}

/// The user's own datum: taken as WGS 84 if its ellipsoid is WGS 84's or GRS 1980.
Result<CrsDefinition> own_datum(KeyReader& keys) {
  CrsDefinition d;
  d.datum = "an unnamed datum";
  d.datum_offset_m = -1;
  const std::string written = keys.text({geog_citation});
  const std::string called = written.empty() ? "of the file" : "\"" + written + "\"";
  const int code = keys.code(geog_ellipsoid).value_or(user_defined);
  if (code != user_defined) {
    const Ellipsoid* known = find_ellipsoid(code);
    if (!known) {
      return key_fault(geog_ellipsoid, ErrorCode::unsupported_version,
                       datum_refusal(fmt::format("{} on ellipsoid EPSG:{}", called, code)));
    }
    d.ellipsoid = *known;
    return d;
  }
  const auto major_m = keys.number(geog_semi_major);
  if (!major_m)
    return key_fault(geographic_type, ErrorCode::not_found, "neither a datum nor an ellipsoid is given");
  double inverse = keys.number(geog_inverse_flattening).value_or(0);
  if (inverse == 0) {
    const double minor_m = keys.number(geog_semi_minor).value_or(*major_m);
    inverse = minor_m == *major_m ? 0 : *major_m / (*major_m - minor_m);
  }
  if (!(std::abs(*major_m - wgs84_ellipsoid.equatorial_radius_m) < 30000)) {
    return key_fault(
        geog_semi_major, ErrorCode::unsupported_version,
        fmt::format("a radius of {} m is not the Earth's; only the Earth is supported", *major_m));
  }
  if (!(std::abs(*major_m - wgs84_ellipsoid.equatorial_radius_m) < 0.1 &&
        std::abs(inverse - 298.25722) < 1e-4)) {
    return key_fault(
        geog_semi_major, ErrorCode::unsupported_version,
        datum_refusal(fmt::format("{} on an ellipsoid of {} m and 1/{}", called, *major_m, inverse)));
  }
  d.ellipsoid = {*major_m, inverse};
  return d;
}

/// Name, ellipsoid and offset of the datum; method and parameters are left alone.
Result<CrsDefinition> datum_of(KeyReader& keys) {
  for (const double shift : keys.numbers(geog_to_wgs84)) {
    if (shift != 0) {
      return key_fault(
          geog_to_wgs84, ErrorCode::unsupported_version,
          "the datum is shifted from WGS 84, and shifts of datum are not supported; reproject the "
          "raster to WGS 84 (EPSG:4326) first");
    }
  }
  const int system = keys.code(geographic_type).value_or(user_defined);
  if (system != user_defined) return crs_from_epsg(system);
  const int datum_code = keys.code(geog_datum).value_or(user_defined);
  if (datum_code == user_defined) return own_datum(keys);
  if (const Datum* datum = find_datum_by_code(datum_code)) return crs_from_epsg(datum->geographic_epsg);
  const char* refused = refused_datum_by_code(datum_code);
  return key_fault(geog_datum, ErrorCode::unsupported_version,
                   datum_refusal(refused ? refused : fmt::format("EPSG:{}", datum_code)));
}

Result<CrsDefinition> geographic(KeyReader& keys) {
  auto d = datum_of(keys);
  if (!d) return d;
  const auto unit_deg = angular_unit_deg(keys);
  if (!unit_deg) return fail(unit_deg.error());
  d->unit = *unit_deg;
  if (const auto meridian = keys.number(geog_prime_meridian_long)) {
    d->prime_meridian_deg = *meridian * *unit_deg;
  } else if (keys.code(geog_prime_meridian).value_or(8901) != 8901) {
    return key_fault(geog_prime_meridian, ErrorCode::unsupported_version,
                     "only Greenwich (8901) or a longitude in key 2061 is supported as prime meridian");
  }
  return d;
}

/// A system by its code, checked against a unit that the file may state besides.
Result<CrsDefinition> projected_by_code(KeyReader& keys, int code) {
  auto d = crs_from_epsg(code);
  if (!d) return d;
  const auto unit_m = linear_unit(keys);
  if (!unit_m) return fail(unit_m.error());
  if (*unit_m && std::abs(**unit_m - d->unit) > 1e-9 * d->unit) {
    return key_fault(
        proj_unit, ErrorCode::invalid_input,
        fmt::format("{} has units of {} m, but the file says {} m; name the right system with --crs", d->name,
                    d->unit, **unit_m));
  }
  return d;
}

/// Zones of UTM as "projection" codes: 16001 to 16060 north, 16101 to 16160 south.
std::optional<CrsDefinition> utm_by_projection_code(KeyReader& keys, const CrsDefinition& base) {
  const int code = keys.code(projection).value_or(user_defined);
  const int zone = code % 100;
  if (code / 200 != 80 || zone < 1 || zone > 60) return std::nullopt;
  CrsDefinition d = utm_zone(zone, code > 16100, 4326);
  d.name = fmt::format("{} / UTM zone {}{}", base.datum, zone, code > 16100 ? 'S' : 'N');
  d.datum = base.datum;
  d.datum_offset_m = base.datum_offset_m;
  d.ellipsoid = base.ellipsoid;
  return d;
}

struct MethodOfCode {
  int code;
  CrsMethod method;
};
constexpr MethodOfCode methods[] = {
    {1, CrsMethod::transverse_mercator}, {7, CrsMethod::mercator}, {8, CrsMethod::lambert_conformal},
    {9, CrsMethod::lambert_conformal},   {11, CrsMethod::albers},  {15, CrsMethod::polar_stereographic}};

Result<CrsMethod> method_of(int code) {
  const auto found = std::ranges::find(methods, code, &MethodOfCode::code);
  if (found != std::end(methods)) return found->method;
  const bool named = code > 0 && code < static_cast<int>(std::size(method_names));
  return key_fault(proj_method, ErrorCode::unsupported_version,
                   fmt::format("{} is not supported; reproject the raster first",
                               named ? method_names[code] : fmt::format("projection method {}", code)));
}

/// Standard parallels, and for the pole's plane which pole; what each method means by its latitudes.
std::optional<int> set_parallels(KeyReader& keys, int code, double degrees, CrsDefinition& d) {
  const auto first = keys.number(std_parallel_1), second = keys.number(std_parallel_2);
  if (code == 8 || d.method == CrsMethod::albers) {
    if (!first) return std_parallel_1;
    d.parallel_1_deg = *first * degrees;
    d.parallel_2_deg = second.value_or(*first) * degrees;
  } else if (code == 9) {
    d.parallel_1_deg = d.parallel_2_deg = d.latitude_origin_deg;
  } else if (d.method == CrsMethod::mercator) {
    d.parallel_1_deg = first.value_or(0) * degrees;
  } else if (d.method == CrsMethod::polar_stereographic) {
    if (!first && d.latitude_origin_deg == 0) return nat_origin_lat;
    d.parallel_1_deg = first ? *first * degrees : d.latitude_origin_deg;
    const double pole = d.latitude_origin_deg != 0 ? d.latitude_origin_deg : d.parallel_1_deg;
    d.latitude_origin_deg = std::copysign(90.0, pole);
  }
  return std::nullopt;
}

Result<CrsDefinition> projected_by_method(KeyReader& keys, CrsDefinition d, double degrees) {
  const auto code = keys.code(proj_method);
  if (!code || *code == user_defined) {
    return key_fault(proj_method, ErrorCode::not_found,
                     "neither a code nor a method of projection is given; name the system with --crs");
  }
  const auto method = method_of(*code);
  if (!method) return fail(method.error());
  const auto unit_m = linear_unit(keys);
  if (!unit_m) return fail(unit_m.error());
  const std::string written = keys.text({projected_citation, citation});
  d.name = written.empty() ? d.datum + " / projection of the file" : written;
  d.method = *method;
  d.unit = unit_m->value_or(1);
  d.longitude_origin_deg =
      degrees *
      keys.number({nat_origin_long, false_origin_long, center_long, straight_vert_pole_long}).value_or(0);
  if (*method == CrsMethod::polar_stereographic) {
    d.longitude_origin_deg =
        degrees * keys.number({straight_vert_pole_long, nat_origin_long, center_long}).value_or(0);
  }
  d.latitude_origin_deg = degrees * keys.number({nat_origin_lat, false_origin_lat, center_lat}).value_or(0);
  d.scale = keys.number({scale_at_nat_origin, scale_at_center}).value_or(1);
  d.false_easting_m = d.unit * keys.number({false_easting, false_origin_easting, center_easting}).value_or(0);
  d.false_northing_m =
      d.unit * keys.number({false_northing, false_origin_northing, center_northing}).value_or(0);
  if (const auto missing = set_parallels(keys, *code, degrees, d)) {
    return key_fault(*missing, ErrorCode::not_found, "a parameter of the projection is missing");
  }
  return d;
}

Result<CrsDefinition> projected(KeyReader& keys) {
  const int code = keys.code(projected_type).value_or(user_defined);
  if (code != user_defined) return projected_by_code(keys, code);
  auto base = geographic(keys);
  if (!base) return base;
  const double degrees = base->unit;
  base->unit = 1;
  if (auto utm = utm_by_projection_code(keys, *base)) {
    const auto unit_m = linear_unit(keys);
    if (!unit_m) return fail(unit_m.error());
    utm->unit = unit_m->value_or(1);
    return *utm;
  }
  return projected_by_method(keys, *base, degrees);
}

Result<CrsDefinition> by_model(KeyReader& keys) {
  const int model = keys.code(model_type)
                        .value_or(keys.code(projected_type)    ? 1
                                  : keys.code(geographic_type) ? 2
                                                               : 0);
  if (model == 1) return projected(keys);
  if (model == 2) return geographic(keys);
  if (model == 3) {
    return key_fault(model_type, ErrorCode::unsupported_version,
                     "geocentric coordinates are not those of a raster");
  }
  return key_fault(model_type, ErrorCode::not_found,
                   "the file does not say its reference system; name it with --crs");
}

}  // namespace

Result<CrsDefinition> crs_from_geokeys(std::span<const GeoKey> all) {
  KeyReader keys(all);
  auto definition = by_model(keys);
  if (keys.wrong()) return key_fault(*keys.wrong(), ErrorCode::corrupt, "expected one number");
  return definition;
}

Result<Crs> crs_of(const CrsDescription& description) {
  switch (description.kind) {
    case CrsDescription::Kind::geographic_wgs84:
      return Crs::from_epsg(4326);
    case CrsDescription::Kind::epsg: {
      const bool fits = description.epsg <= 1'000'000;
      return Crs::from_epsg(fits ? static_cast<int>(description.epsg) : 0);
    }
    case CrsDescription::Kind::geo_keys: {
      auto definition = crs_from_geokeys(description.geo_keys);
      if (!definition) return fail(definition.error());
      return Crs::from_definition(std::move(*definition));
    }
    case CrsDescription::Kind::wkt:
      if (const auto code = epsg_of_wkt(description.text)) return Crs::from_epsg(*code);
      return fail(
          ErrorCode::invalid_input, "", "",
          "the well-known text of the reference system has no EPSG code; name the system with --crs EPSG:n");
    case CrsDescription::Kind::unknown:
      break;
  }
  return fail(ErrorCode::not_found, "", "",
              "the file does not say its reference system; name it with --crs EPSG:n");
}

}  // namespace cuesta
