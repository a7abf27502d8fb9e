#pragma once
/// Which vertical datum a mosaic answers in, and how each file's heights come to it.

#include "terrain/mosaic.h"
#include "terrain/mosaic_field.h"

namespace cuesta {

struct MosaicDatums {
  VerticalDatum datum = VerticalDatum::unknown;  ///< of the result
  std::vector<DatumStep> steps = {};             ///< of every file
  std::vector<std::string> warnings = {};
};

/// @error invalid_input: files above different datums and no word which to answer in; a file that needs a
/// geoid
///        and there is none, or whose place on the Earth is not known.
Result<MosaicDatums> choose_datums(std::span<const RasterInfo> infos, std::span<const Crs> systems,
                                   const MosaicOptions& options);

}  // namespace cuesta
