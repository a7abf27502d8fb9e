#pragma once
/// The GeoKeyDirectory of a GeoTIFF. Source: OGC 19-008r4, "GeoTIFF 1.1", clauses 7 and 8, annex C.

#include <optional>
#include <span>
#include <string_view>

#include "ooc/result.h"
#include "terrain/raster_info.h"

namespace cuesta {

/// Ids that readers of heights ask for; terrain/crs asks for the others.
namespace geo_key {
inline constexpr std::uint16_t model_type = 1024;   ///< 1 projected, 2 geographic, 3 geocentric
inline constexpr std::uint16_t raster_type = 1025;  ///< 1 pixel is area, 2 pixel is point
inline constexpr std::uint16_t geodetic_crs = 2048;
inline constexpr std::uint16_t projected_crs = 3072;
inline constexpr std::uint16_t vertical_crs = 4096;
inline constexpr std::uint16_t vertical_citation = 4097;
inline constexpr std::uint16_t vertical_units = 4099;
}  // namespace geo_key

/// The entries with their values, by rising id. An entry that points outside its array, or has a tag that is
/// not one of the three, is an error; of an id that is there twice the first counts.
/// @error corrupt, without file.
Result<std::vector<GeoKey>> parse_geo_keys(std::span<const std::uint16_t> directory,
                                           std::span<const double> doubles, std::string_view ascii);

/// Null when it is not there, or of another kind.
const GeoKey* find_key(std::span<const GeoKey> keys, std::uint16_t id);
std::optional<std::uint16_t> short_key(std::span<const GeoKey> keys, std::uint16_t id);

/// Vertical datum, its name and unit from the keys; what they do not say stays as it is in `info`.
/// @error unsupported_version, without file: a unit that is none of those known.
Result<void> apply_vertical_keys(std::span<const GeoKey> keys, RasterInfo& info);

}  // namespace cuesta
