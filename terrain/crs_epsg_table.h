#pragma once
/// The rows behind crs_epsg.h.

#include <span>

#include "terrain/crs_definition.h"

namespace cuesta {

struct EpsgProjected {
  int code;
  int geographic_epsg;
  const char* name;
  CrsMethod method;
  double latitude_origin_deg, longitude_origin_deg, parallel_1_deg, parallel_2_deg, scale;
  double false_easting_m, false_northing_m;
  double unit_m;
};

/// A run of codes that are UTM zones, one after the other.
struct EpsgUtmRun {
  int first, last;
  int first_zone;
  bool south;
  int geographic_epsg;
  const char* name;  ///< before the zone's number: "GDA94 / MGA zone "
  const char* hemisphere;
};

struct EpsgRefused {
  int code;
  const char* name;
  const char* method;  ///< that is not supported; "" if it is the datum
  const char* datum;
};

std::span<const EpsgProjected> epsg_projected();  ///< ascending codes
std::span<const EpsgUtmRun> epsg_utm_runs();
std::span<const EpsgRefused> epsg_refused();  ///< ascending codes

}  // namespace cuesta
