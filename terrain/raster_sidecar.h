#pragma once
/// What the user wrote beside a raster that does not say what it is: `<file>.json`, or `raster.json` in a
/// folder of tiles. One JSON object; every key may be missing, none may be unknown:
///
///     { "format": "raw",              hgt, geotiff, ascii-grid, png, tiles, raw, netcdf, usgs-dem
///       "placement": { "x": 86.0, "y": 28.0, "x_spacing": 0.000833, "y_spacing": 0.000833,
///                      "pixel_is": "point" },           of the upper left posting; "area": of its corner
///       "epsg": 4326, "vertical_datum": "orthometric",  or ellipsoidal
///       "no_data": -32768, "scale": 1, "offset": 0, "unit_m": 1,
///       "type": "int16", "byte_order": "little", "width": 1025, "height": 1025, "header_bytes": 0,
///       "png_heights": "gray",        or terrain-rgb, terrarium
///       "zoom": 12, "variable": "ROSE" }

#include "terrain/height_raster.h"

namespace cuesta {

std::filesystem::path sidecar_path(const std::filesystem::path& raster);

/// Sets those `options` that are not set yet. @return whether there is a sidecar.
/// @error corrupt: not JSON, or larger than 1 MiB; invalid_input: an unknown key, or a value of a wrong kind;
/// the file is the sidecar.
Result<bool> read_sidecar(const std::filesystem::path& raster, RasterOptions& options);

/// The same from text. @param path  for messages.
Result<void> parse_sidecar(std::string_view text, const std::filesystem::path& path, RasterOptions& options);

}  // namespace cuesta
