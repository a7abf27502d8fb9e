#pragma once
/// Which rasters lie on one lattice, and where in it.

#include "terrain/mosaic.h"
#include "terrain/raster_turn.h"

namespace cuesta {

/// Posting (c, r) of the turned file is posting (column + c, row + r) of the layer, columns modulo
/// columns_around where that is not 0.
struct FilePlace {
  std::uint32_t layer = 0;
  std::uint64_t column = 0, row = 0;
  RasterTurn turn = {};
};

struct MosaicLayers {
  std::vector<MosaicLayer> layers;  ///< by falling priority
  std::vector<FilePlace> places;    ///< of every file
};

/// The systems of all files: those of files that do not say are a plane in metres, all or none of them.
/// @error as crs_of(), with the file; invalid_input, with a file that does not say while another does.
Result<std::vector<Crs>> systems_of(std::span<const RasterInfo> infos);

/// @pre as many systems as infos.
/// @error invalid_input: postings beyond a pole; a layer of more than 2^62 postings.
Result<MosaicLayers> group_into_layers(std::span<const RasterInfo> infos, std::span<const Crs> systems,
                                       MosaicPriority priority);

/// Distance of postings along a column, in metres; of geographic systems at 111,320 m per degree.
double row_spacing_m(const MosaicLayer& layer);

/// Degrees that are 360 of the system's own unit: the x after which a geographic system repeats itself.
inline double full_turn(const Crs& crs) {
  return 360 / crs.definition().unit;
}

}  // namespace cuesta
