#pragma once
/// One function per format, and what all of them do with the options. For open_height_raster() and fuzzing.

#include <memory>

#include "terrain/height_raster.h"
#include "terrain/raster_file.h"

namespace cuesta {

using RasterResult = Result<std::unique_ptr<HeightRaster>>;

// The caller has recognised the format. None throws.
RasterResult open_hgt(RasterFile file, const RasterOptions& options);
RasterResult open_geotiff(RasterFile file, const RasterOptions& options);
RasterResult open_ascii_grid(RasterFile file, const RasterOptions& options);
RasterResult open_png(RasterFile file, const RasterOptions& options);
RasterResult open_raw(RasterFile file, const RasterOptions& options);
RasterResult open_netcdf(RasterFile file, const RasterOptions& options);
RasterResult open_usgs_dem(RasterFile file, const RasterOptions& options);
RasterResult open_tile_folder(const std::filesystem::path& folder, const RasterOptions& options);

/// Whether the text begins with the header of a USGS DEM and that of its first profile; it has no magic
/// bytes.
bool looks_like_usgs_dem(std::string_view text);

/// The reader that content, options and name call for. @pre check_options() was good; no sidecar is looked
/// for.
RasterResult open_raster(RasterFile file, const RasterOptions& options);

/// Beyond this the sizes of a raster are not believed.
inline constexpr std::uint64_t most_postings_per_side = std::uint64_t{1} << 31;
inline constexpr std::uint64_t most_postings = std::uint64_t{1} << 48;

/// @error invalid_input, with what is wrong in the options or sidecar.
Result<void> check_options(const RasterOptions& options, const std::filesystem::path& path);
/// Puts what the options say over what the file said.
void apply_options(RasterInfo& info, const RasterOptions& options);
/// @error corrupt when a side is 0 or too large, or the map is not finite or squeezes postings together.
Result<void> check_info(const RasterInfo& info, const RasterFile& file);

/// Where the postings of a grid are whose rows come from the north: from the upper left one, or the corner.
PostingMap map_of(const Placement& placement);

}  // namespace cuesta
