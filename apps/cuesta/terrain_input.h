#pragma once
/// Rasters of heights as the input of a build: what the user chose of their places and heights, and what
/// became of it.

#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "ooc/result.h"
#include "terrain/geoid.h"
#include "terrain/image_drape.h"
#include "terrain/mosaic.h"
#include "terrain/terrain_metadata.h"
#include "terrain/terrain_surface.h"

namespace cuesta::app {

enum class FrameChoice : std::uint8_t { automatic, ecef, enu, projected };

struct TerrainSettings {
  std::string crs;    ///< "EPSG:n" of files that do not say, or say it wrong; empty: their own
  std::string geoid;  ///< name or file for geoid.h: heights become ellipsoidal; empty: they stay as they are
  VerticalDatum heights = VerticalDatum::unknown;  ///< of the files; unknown: as they say themselves
  FrameChoice frame = FrameChoice::automatic;
  std::optional<LatLon> origin;  ///< of a local frame; default: the middle
  MosaicPriority priority = MosaicPriority::finest_first;
  std::optional<double> sea_level_m, no_data;
  std::uint32_t fill_postings = 0;
  std::optional<unsigned> zoom;        ///< of a folder of tiles
  std::string variable;                ///< of a netCDF file; empty: the only one
  std::filesystem::path drape;         ///< image that gives the colours; empty: none
  std::optional<GeoBox> drape_bounds;  ///< where it lies, if it does not say so
};

/// Whether a path is taken as a raster: by its name, or as it is a folder.
bool is_raster(const std::filesystem::path& path);

/// The files that decide about a raster or an image: it, its tiles, its sidecars. Sorted.
std::vector<std::filesystem::path> files_of_raster(const std::filesystem::path& path);

struct TerrainInput {
  std::unique_ptr<Geoid> geoid;  ///< null where none is needed
  std::unique_ptr<Mosaic> mosaic;
  std::unique_ptr<ImageDrape> drape;  ///< null without an image
  TerrainFacts facts;                 ///< all but what only the survey knows
  std::vector<std::string> warnings;  ///< the mosaic's, and of files that are taken as a plane in metres but
                                      ///< look like degrees
};

/// @error of Mosaic::open(), Geoid::open() and Crs::from_name(); invalid_input: a frame that these files
/// cannot be in
Result<TerrainInput> open_terrain(std::span<const std::filesystem::path> paths,
                                  const TerrainSettings& settings, const std::filesystem::path& temp);

/// Adds what the survey has found.
void note_survey(const TerrainSurface& surface, const Mosaic& mosaic, TerrainFacts& facts);

}  // namespace cuesta::app
