#include "terrain/crs.h"

#include <fmt/format.h>

#include <charconv>
#include <cmath>
#include <limits>

#include "ooc/check.h"
#include "terrain/crs_epsg.h"
#include "terrain/crs_projection.h"

namespace cuesta {
namespace {

constexpr double nan = std::numeric_limits<double>::quiet_NaN();
constexpr double pole_slack_deg = 1e-9;  // 0.1 mm: what a row of postings counted from a corner may be off

/// NaN for what lies beyond a pole; also for NaN.
double latitude(double lat_deg) {
  if (!(std::abs(lat_deg) <= 90 + pole_slack_deg)) return nan;
  return std::min(90.0, std::max(-90.0, lat_deg));
}

/// What is wrong with the parameters; empty if nothing is.
std::string fault(const CrsDefinition& d) {
  const double all[] = {d.unit,
                        d.prime_meridian_deg,
                        d.latitude_origin_deg,
                        d.longitude_origin_deg,
                        d.parallel_1_deg,
                        d.parallel_2_deg,
                        d.scale,
                        d.false_easting_m,
                        d.false_northing_m,
                        d.ellipsoid.equatorial_radius_m,
                        d.ellipsoid.inverse_flattening};
  for (const double value : all) {
    if (!std::isfinite(value)) return "a parameter is not a finite number";
  }
  if (!(d.unit > 0)) return fmt::format("the unit must be greater than 0, found {}", d.unit);
  if (!(d.scale > 0)) return fmt::format("the scale must be greater than 0, found {}", d.scale);
  for (const double lat_deg : {d.latitude_origin_deg, d.parallel_1_deg, d.parallel_2_deg}) {
    if (std::abs(lat_deg) > 90)
      return fmt::format("a latitude must be within ±90 degrees, found {}", lat_deg);
  }
  if (!(d.ellipsoid.equatorial_radius_m > 0)) return "the ellipsoid's radius must be greater than 0";
  if (d.ellipsoid.inverse_flattening != 0 && !(d.ellipsoid.inverse_flattening > 2)) {
    return fmt::format("the ellipsoid's inverse flattening must be 0 or greater than 2, found {}",
                       d.ellipsoid.inverse_flattening);
  }
  if (d.method == CrsMethod::polar_stereographic && std::abs(d.latitude_origin_deg) != 90) {
    return fmt::format("polar stereographic needs a pole (±90 degrees) as latitude of origin, found {}",
                       d.latitude_origin_deg);
  }
  const bool cone = d.method == CrsMethod::lambert_conformal || d.method == CrsMethod::albers;
  const bool pole = std::abs(d.parallel_1_deg) == 90 || std::abs(d.parallel_2_deg) == 90;
  if (pole && ((cone && d.parallel_1_deg != d.parallel_2_deg) || d.method == CrsMethod::mercator)) {
    return "a pole cannot be one of the standard parallels";
  }
  return "";
}

std::string unit_text(const CrsDefinition& d) {
  if (d.method == CrsMethod::geographic)
    return d.unit == 1 ? "degrees" : fmt::format("units of {} degrees", d.unit);
  if (d.unit == 1) return "metres";
  if (d.unit == foot_m) return "feet";
  if (std::abs(d.unit - us_survey_foot_m) < 1e-12) return "US survey feet";
  return fmt::format("units of {} m", d.unit);
}

}  // namespace

const char* name(CrsMethod method) {
  switch (method) {
    case CrsMethod::geographic:
      return "latitude and longitude";
    case CrsMethod::transverse_mercator:
      return "transverse Mercator";
    case CrsMethod::mercator:
      return "Mercator";
    case CrsMethod::web_mercator:
      return "Web Mercator";
    case CrsMethod::lambert_conformal:
      return "Lambert conformal conic";
    case CrsMethod::albers:
      return "Albers equal area";
    case CrsMethod::polar_stereographic:
      return "polar stereographic";
    case CrsMethod::plane:
      return "plane";
  }
  return "unknown";
}

Crs::Crs(CrsDefinition definition, std::shared_ptr<const Projection> projection)
    : definition_(std::move(definition)), projection_(std::move(projection)) {}

Result<Crs> Crs::from_definition(CrsDefinition definition) {
  if (const std::string wrong = fault(definition); !wrong.empty()) {
    return fail(ErrorCode::invalid_input, "", definition.name, wrong);
  }
  if (definition.method == CrsMethod::geographic) return Crs(std::move(definition), nullptr);
  auto projection = make_projection(definition);
  if (!projection) return fail(projection.error());
  return Crs(std::move(definition), std::move(*projection));
}

Result<Crs> Crs::from_epsg(int code) {
  auto definition = crs_from_epsg(code);
  if (!definition) return fail(definition.error());
  return from_definition(std::move(*definition));
}

Result<int> Crs::code_of_name(std::string_view name) {
  std::string_view digits = name;
  if (digits.size() > 5 && (digits.starts_with("EPSG:") || digits.starts_with("epsg:")))
    digits.remove_prefix(5);
  int code = 0;
  const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), code);
  if (error != std::errc{} || end != digits.data() + digits.size() || code <= 0) {
    return fail(ErrorCode::invalid_input, "", std::string(name),
                "expected a code such as EPSG:4326 or EPSG:32633; definitions in words are not read");
  }
  return code;
}

Result<Crs> Crs::from_name(std::string_view name) {
  const auto code = code_of_name(name);
  if (!code) return fail(code.error());
  return from_epsg(*code);
}

Crs Crs::plane() {
  CrsDefinition definition;
  definition.name = "a plane that is nowhere on the Earth";
  definition.method = CrsMethod::plane;
  auto projection = make_projection(definition);
  CUESTA_CHECK(projection.has_value());
  return Crs(std::move(definition), std::move(*projection));
}

LatLon Crs::lat_lon(PlanePoint p) const {
  const CrsDefinition& d = definition_;
  LatLon at =
      projection_ ? projection_->inverse({p.x * d.unit, p.y * d.unit}) : LatLon{p.y * d.unit, p.x * d.unit};
  at.lat_deg = latitude(at.lat_deg);
  at.lon_deg = std::remainder(at.lon_deg + d.prime_meridian_deg, 360);
  if (std::isnan(at.lat_deg) || std::isnan(at.lon_deg)) return {nan, nan};
  return at;
}

PlanePoint Crs::coordinates(LatLon at) const {
  const CrsDefinition& d = definition_;
  const LatLon local{latitude(at.lat_deg), std::remainder(at.lon_deg - d.prime_meridian_deg, 360)};
  if (std::isnan(local.lat_deg) || std::isnan(local.lon_deg)) return {nan, nan};
  if (!projection_) return {local.lon_deg / d.unit, local.lat_deg / d.unit};
  const PlanePoint p_m = projection_->forward(local);
  return {p_m.x / d.unit, p_m.y / d.unit};
}

std::string Crs::description() const {
  const CrsDefinition& d = definition_;
  std::string text = fmt::format("{}, {}, {}", d.name, name(d.method), unit_text(d));
  if (d.datum_offset_m > 0) {
    text +=
        fmt::format("; {} is taken as WGS 84, from which it is up to {} m away", d.datum, d.datum_offset_m);
  } else if (d.datum_offset_m < 0) {
    text += fmt::format("; {} is taken as WGS 84, how far it is away is not known", d.datum);
  }
  return text;
}

bool same_coordinates(const CrsDefinition& a, const CrsDefinition& b) {
  if (a.method != b.method || a.unit != b.unit || a.prime_meridian_deg != b.prime_meridian_deg) return false;
  if (a.method == CrsMethod::geographic || a.method == CrsMethod::plane) return true;
  return a.latitude_origin_deg == b.latitude_origin_deg && a.longitude_origin_deg == b.longitude_origin_deg &&
         a.parallel_1_deg == b.parallel_1_deg && a.parallel_2_deg == b.parallel_2_deg && a.scale == b.scale &&
         a.false_easting_m == b.false_easting_m && a.false_northing_m == b.false_northing_m &&
         a.ellipsoid.equatorial_radius_m == b.ellipsoid.equatorial_radius_m &&
         a.ellipsoid.inverse_flattening == b.ellipsoid.inverse_flattening;
}

}  // namespace cuesta
