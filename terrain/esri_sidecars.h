#pragma once
/// World files and .prj files beside rasters: six numbers that place it, and well-known text of its system.
/// Source: Esri, "World files for raster datasets".

#include "terrain/raster_file.h"
#include "terrain/raster_info.h"

namespace cuesta {

/// Places a raster that does not say where it lies by the world file beside it: for a.tif a.tfw, a.tifw or
/// a.wld, for a.png a.pgw, a.pngw or a.wld. Does nothing where there is none. The file is added to
/// info.files.
/// @error corrupt: not six numbers, with the file and line.
Result<void> read_world_file(const RasterFile& file, RasterInfo& info);

/// The same for the reference system of a raster that does not say it: a.prj.
void read_prj(const RasterFile& file, RasterInfo& info);

}  // namespace cuesta
