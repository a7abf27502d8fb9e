#pragma once
/// Terrain of any size from small ones: a relief, upsampled smoothly, with fractal detail, for tests and
/// benchmarks larger than any that could travel with them. Same relief and options give the same bytes, for
/// any number of threads.

#include <cstdint>
#include <filesystem>

#include "tools/terrain_generator/relief.h"

namespace cuesta::tools {

struct TerrainOptions {
  std::uint64_t side = 4097;  ///< postings, at least 2
  std::uint64_t seed = 1;     ///< of the detail
  /// Amplitude of the longest waves of the detail, one posting of the relief long, as a share of the relief's
  /// rise over one posting there. Shorter ones, down to two postings, have half of it each time. 0: smooth.
  double roughness = 0.5;
  double spacing_m = 30;
  std::uint32_t epsg = 32645;                           ///< UTM zone 45 north: the Himalaya
  double centre_x_m = 500'000, centre_y_m = 3'100'000;  ///< easting and northing of the middle
};

/// Writes `path`, side · side little-endian int16 in whole metres, rows from the north, and `path`.json, the
/// sidecar that places it (terrain/raster_sidecar.h). Both appear whole or not at all; the sidecar first.
/// @error io; of relief.read; invalid_input: a side below 2.
/// @cost  16,385² of 1025²: 16 s of processor time; memory of 64 rows and the rows of the relief under them.
Result<void> make_terrain(const Relief& relief, const std::filesystem::path& path,
                          const TerrainOptions& options);

}  // namespace cuesta::tools
