#include "tests/fuzz/fuzz_terrain.h"

FUZZ_RASTER("a.dem", .format = cuesta::RasterFormat::usgs_dem)
