/// netCDF through its library, which is not instrumented and believes much of a damaged HDF5 file: run with
/// -fork=1 -ignore_ooms=1 -ignore_timeouts=1 -timeout=5, starting from good files.
#include "tests/fuzz/fuzz_terrain.h"

FUZZ_RASTER("a.nc", .format = cuesta::RasterFormat::netcdf, .unit_m = 1.0)
