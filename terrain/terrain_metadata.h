#pragma once
/// What a .cuesta file says of itself as terrain: the object "terrain" of its metadata.
///
/// Vertices of such a file are at Frame::position_m(place), with heights of the kind that `heights` names.
/// Numbers survive the way through the text bit for bit. Threads: free functions, no state.
///
///     "terrain": { "frame": {"kind": "projected", "description": "…", "crs": {"method": "lambert_conformal",
///     …}},
///                  "heights": "ellipsoidal", "geoid": "egm96-15", "least_m": -3.5, "most_m": 8806,
///                  "sea_level_m": -30.1, "bounds": {"west": 86, "south": 27, "east": 87, "north": 28},
///                  "spacing_m": 92.6, "postings": 1442401, "no_data": 0, "filled": 12, "raised": 0, "files":
///                  [{"name": "N27E086.hgt", "format": "SRTM", "crs": "EPSG:4326 …",
///                             "vertical_datum": "orthometric", "vertical_name": "EGM96", "postings":
///                             1442401}] }

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "ooc/result.h"
#include "terrain/frame.h"
#include "terrain/raster_info.h"

namespace cuesta {

/// A part of the globe between two meridians and two parallels, in degrees. It reaches east from `west`, so
/// that east >= west, and more than 180 where it crosses the antimeridian.
struct GeoBox {
  double west_deg = 0, south_deg = 0, east_deg = 0, north_deg = 0;
  bool operator==(const GeoBox&) const = default;
};

/// One of the rasters that the terrain was made of.
struct TerrainFile {
  std::string name;                                       ///< without its folder
  std::string format;                                     ///< "SRTM", "GeoTIFF"
  std::string crs;                                        ///< Crs::description()
  VerticalDatum vertical_datum = VerticalDatum::unknown;  ///< of its own heights
  std::string vertical_name;                              ///< "EGM96"; may be empty
  std::uint64_t postings = 0;
  bool operator==(const TerrainFile&) const = default;
};

struct TerrainFacts {
  Frame frame = Frame::ecef();
  /// What heights above the ellipsoid (ecef, enu) or the plane (projected) are. Orthometric ones in a frame
  /// of the globe were taken as if they were ellipsoidal.
  VerticalDatum heights = VerticalDatum::unknown;
  std::string
      geoid;  ///< ellipsoidal heights: that was added; orthometric ones: that they refer to; may be empty
  double least_m = 0, most_m = 0;  ///< of all heights
  /// Height of the sea in the middle of the bounds, for its colours: the geoid's undulation there where
  /// heights are ellipsoidal.
  double sea_level_m = 0;
  std::optional<GeoBox> bounds;  ///< of all postings with data, if known
  double spacing_m = 0;          ///< of the finest raster's postings, about; 0: unknown
  std::uint64_t postings = 0;    ///< with data
  std::uint64_t no_data = 0;     ///< postings without, that are holes
  std::uint64_t filled = 0;      ///< postings without, that were given heights
  std::uint64_t raised = 0;      ///< postings lifted to the least height that was asked for
  std::vector<TerrainFile> files;
};

/// The object that belongs under "terrain". Bytes that are no UTF-8 in names become U+FFFD.
/// @pre all numbers are finite, least_m <= most_m.
std::string terrain_json(const TerrainFacts& facts);

/// @param metadata  Directory::metadata: the whole object.
/// @return nothing for a file that is no terrain: it has no object "terrain", or its metadata are no JSON.
/// @error corrupt: an object "terrain" with a key that is missing or of a wrong kind; the place names it;
///        invalid_input: a frame that cannot be.
Result<std::optional<TerrainFacts>> terrain_facts(std::string_view metadata);

/// "ellipsoidal", "orthometric", "unknown"
const char* name(VerticalDatum datum);

}  // namespace cuesta
