#pragma once
/// Where a GeoTIFF's pixels lie: its tags for the map from raster space to coordinates.

#include <optional>
#include <span>

#include "terrain/geo_keys.h"
#include "terrain/tiff_handle.h"

namespace cuesta {

/// From a transformation, or one tie point with a scale; of the middles of pixels that are areas. Nothing
/// where the file has neither.
/// @error unsupported_version: several ground control points and no transformation.
Result<std::optional<PostingMap>> tiff_placement(const TiffHandle& handle, std::span<const GeoKey> keys);

}  // namespace cuesta
