#pragma once
/// EPSG codes as parameters. Source: EPSG dataset v10. A small table: what elevation data come in, not all
/// codes.
///
/// Supported: geographic systems of the datums in crs_datum.h; UTM zones of WGS 84, ETRS89, NAD83 and its
/// successors, SIRGAS 2000, JGD, GDA94 and GDA2020; UPS; Web Mercator; polar stereographic systems; the
/// national grids of many countries in Lambert, Albers and transverse Mercator; NAD83 state planes in metres
/// and feet.

#include <vector>

#include "ooc/result.h"
#include "terrain/crs_definition.h"

namespace cuesta {

/// @error unsupported_version: known and refused, by name with the reason; not_found: not in the table.
Result<CrsDefinition> crs_from_epsg(int code);

/// A zone of the Universal Transverse Mercator grid, on the datum of a geographic system.
/// @pre zone is 1 to 60, geographic_epsg is a code that find_datum knows.
CrsDefinition utm_zone(int zone, bool south, int geographic_epsg);

/// All supported codes, ascending: for lists, and for tests.
std::vector<int> supported_epsg_codes();

}  // namespace cuesta
