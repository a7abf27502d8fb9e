#pragma once
/// GeoTIFF's GeoKeys as parameters of a reference system. Source: OGC 19-008r4 "OGC GeoTIFF Standard 1.1",
/// clause 7; GeoTIFF 1.0 §6.3.3 for the codes of projections. Where writers differ (origin in the natural,
/// false or centre keys) all three are read, as libgeotiff does.

#include <span>

#include "ooc/result.h"
#include "terrain/crs.h"
#include "terrain/raster_info.h"

namespace cuesta {

/// The horizontal system that the keys describe. Whether pixels are areas or points (key 1025) and the
/// vertical keys (4096 to 4099) are not looked at.
/// @error unsupported_version: a projection, datum or EPSG code that is refused, by name; invalid_input: keys
/// that
///        contradict each other or have parameters without meaning; not_found: keys are missing. `place`
///        names the key or the system.
Result<CrsDefinition> crs_from_geokeys(std::span<const GeoKey> keys);

/// The system of a raster as its reader describes it.
/// @error as above; not_found where the file does not say, invalid_input for well-known text without a code
///        (crs_wkt.h). The message tells to use --crs.
Result<Crs> crs_of(const CrsDescription& description);

}  // namespace cuesta
