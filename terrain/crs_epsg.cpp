#include "terrain/crs_epsg.h"

#include <fmt/format.h>

#include <algorithm>

#include "ooc/check.h"
#include "terrain/crs_datum.h"
#include "terrain/crs_epsg_table.h"

namespace cuesta {
namespace {

std::string epsg_name(int code, const std::string& name) {
  return fmt::format("EPSG:{} ({})", code, name);
}

CrsDefinition on_datum(const Datum& datum) {
  CrsDefinition d;
  d.name = epsg_name(datum.geographic_epsg, datum.name);
  d.datum = datum.name;
  d.datum_offset_m = datum.wgs84_offset_m;
  d.ellipsoid = datum.ellipsoid;
  return d;
}

CrsDefinition from_row(const EpsgProjected& row) {
  const Datum* datum = find_datum(row.geographic_epsg);
  CUESTA_CHECK(datum, row.code);
  CrsDefinition d = on_datum(*datum);
  d.name = epsg_name(row.code, row.name);
  d.method = row.method;
  d.unit = row.unit_m;
  d.latitude_origin_deg = row.latitude_origin_deg;
  d.longitude_origin_deg = row.longitude_origin_deg;
  d.parallel_1_deg = row.parallel_1_deg;
  d.parallel_2_deg = row.parallel_2_deg;
  d.scale = row.scale;
  d.false_easting_m = row.false_easting_m;
  d.false_northing_m = row.false_northing_m;
  return d;
}

CrsDefinition from_run(const EpsgUtmRun& run, int code) {
  const int zone = run.first_zone + code - run.first;
  CrsDefinition d = utm_zone(zone, run.south, run.geographic_epsg);
  d.name = epsg_name(code, fmt::format("{}{}{}", run.name, zone, run.hemisphere));
  return d;
}

/// Whole families on old datums, told by their code.
std::string refused_family(int code) {
  const auto within = [code](int first, int last) { return code >= first && code <= last; };
  if (within(26701, 26722)) return fmt::format("NAD27 / UTM zone {}N", code - 26700);
  if (within(23028, 23038)) return fmt::format("ED50 / UTM zone {}N", code - 23000);
  if (within(32201, 32260)) return fmt::format("WGS 72 / UTM zone {}N", code - 32200);
  if (within(32301, 32360)) return fmt::format("WGS 72 / UTM zone {}S", code - 32300);
  if (within(28402, 28432)) return fmt::format("Pulkovo 1942 / Gauss-Kruger zone {}", code - 28400);
  return "";
}

Result<CrsDefinition> refuse(int code) {
  const auto rows = epsg_refused();
  if (const auto row = std::ranges::find(rows, code, &EpsgRefused::code); row != rows.end()) {
    const std::string why = *row->method
                                ? fmt::format("{} is not supported; reproject the raster first", row->method)
                                : datum_refusal(row->datum);
    return fail(ErrorCode::unsupported_version, "", epsg_name(code, row->name), why);
  }
  if (const char* datum = refused_datum(code)) {
    return fail(ErrorCode::unsupported_version, "", epsg_name(code, datum), datum_refusal(datum));
  }
  if (const std::string family = refused_family(code); !family.empty()) {
    return fail(ErrorCode::unsupported_version, "", epsg_name(code, family),
                datum_refusal(family.substr(0, family.find(" /"))));
  }
  return fail(
      ErrorCode::not_found, "", fmt::format("EPSG:{}", code),
      "this code is not in the table; known are latitude and longitude (4326, 4258, 4269, …), UTM (326xx, "
      "327xx, 258xx, 269xx, …), UPS, 3857, polar stereographic and many national grids; reproject the "
      "raster to one of them first");
}

}  // namespace

CrsDefinition utm_zone(int zone, bool south, int geographic_epsg) {
  CUESTA_CHECK(zone >= 1 && zone <= 60, zone);
  const Datum* datum = find_datum(geographic_epsg);
  CUESTA_CHECK(datum, geographic_epsg);
  CrsDefinition d = on_datum(*datum);
  d.name = fmt::format("{} / UTM zone {}{}", datum->name, zone, south ? 'S' : 'N');
  d.method = CrsMethod::transverse_mercator;
  d.longitude_origin_deg = 6 * zone - 183;
  d.scale = 0.9996;
  d.false_easting_m = 500000;
  d.false_northing_m = south ? 10000000 : 0;
  return d;
}

Result<CrsDefinition> crs_from_epsg(int code) {
  if (code == 3785 || code == 900913) code = 3857;  // older codes of the same system
  if (const Datum* datum = find_datum(code)) {
    CrsDefinition d = on_datum(*datum);
    d.name = epsg_name(code, datum->name);
    return d;
  }
  for (const EpsgUtmRun& run : epsg_utm_runs()) {
    if (code >= run.first && code <= run.last) return from_run(run, code);
  }
  const auto rows = epsg_projected();
  const auto row = std::ranges::lower_bound(rows, code, {}, &EpsgProjected::code);
  if (row != rows.end() && row->code == code) return from_row(*row);
  return refuse(code);
}

std::vector<int> supported_epsg_codes() {
  std::vector<int> codes;
  for (int code = 1; code <= 32767; ++code) {  // where the codes of EPSG end
    if (crs_from_epsg(code)) codes.push_back(code);
  }
  return codes;
}

}  // namespace cuesta
