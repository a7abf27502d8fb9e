#pragma once
/// Which datums are taken as WGS 84, and which are known and refused. Source: EPSG dataset v10 (names, codes,
/// ellipsoids); the distances are rounded up from the accuracies of its transformations to WGS 84 and from
/// the speed of the plates until 2026.

#include <string>

#include "terrain/crs_definition.h"

namespace cuesta {

struct Datum {
  int geographic_epsg = 0;  ///< of the geographic 2D system: GeoTIFF's GeodeticCRSGeoKey
  int datum_epsg = 0;       ///< GeoTIFF's GeodeticDatumGeoKey
  const char* name = "";    ///< of the geographic system: "ETRS89"
  Ellipsoid ellipsoid;
  double wgs84_offset_m = 0;  ///< about how far from WGS 84 at most; negative: unknown
};

/// The datum of a geographic system, 2D or 3D; null if it is not taken as WGS 84.
const Datum* find_datum(int geographic_epsg);
/// The same from a datum's own code.
const Datum* find_datum_by_code(int datum_epsg);

/// The ellipsoid with this EPSG code; null if it is not one of those that a datum near WGS 84 uses.
const Ellipsoid* find_ellipsoid(int ellipsoid_epsg);

/// True for EPSG codes of geographic systems with ellipsoidal height as third coordinate (EPSG:4979).
bool is_geographic_3d(int geographic_epsg);

/// Name of a geographic system that is known and refused (4267: "NAD27"); null if it is not known.
const char* refused_datum(int geographic_epsg);
/// The same from a datum's own code (6267).
const char* refused_datum_by_code(int datum_epsg);

/// "datum NAD27 is not WGS 84 to within metres, and shifts of datum are not supported; reproject the …"
std::string datum_refusal(const std::string& datum);

}  // namespace cuesta
