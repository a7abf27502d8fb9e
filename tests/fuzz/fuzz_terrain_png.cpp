#include "tests/fuzz/fuzz_terrain.h"

FUZZ_RASTER("a.png", .format = cuesta::RasterFormat::png, .png_heights = cuesta::PngHeights::terrarium)
