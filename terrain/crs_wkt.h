#pragma once
/// The EPSG code that well-known text stands for: what .prj files beside rasters and netCDF's crs_wkt have.
/// Source: OGC 01-009 (WKT 1), OGC 18-010r7 (WKT 2); names of Esri's .prj files, which carry no codes.

#include <optional>
#include <string_view>

namespace cuesta {

/// The code in the outermost AUTHORITY["EPSG","n"] or ID["EPSG",n]; without one, the code of a system that
/// Esri calls by its name (GCS_WGS_1984, WGS_1984_UTM_Zone_33N, …). Parameters are not read.
/// @return nothing where neither is there; the code need not be one that is supported.
std::optional<int> epsg_of_wkt(std::string_view text);

}  // namespace cuesta
