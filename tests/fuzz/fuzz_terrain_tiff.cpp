/// GeoTIFF. libtiff itself is not instrumented, so start from good files: ../shared/data/bad/tiff and what
/// tests/terrain writes. -rss_limit_mb=1000: a block may have 64 MiB, decoded twice.
#include "tests/fuzz/fuzz_terrain.h"

FUZZ_RASTER("a.tif", .format = cuesta::RasterFormat::geotiff)
