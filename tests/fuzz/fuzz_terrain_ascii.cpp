#include "tests/fuzz/fuzz_terrain.h"

FUZZ_RASTER("a.asc", .format = cuesta::RasterFormat::ascii_grid)
