#pragma once
/// The counts in the header of a classic netCDF file, looked at before the library allocates by them.
/// Source: Unidata, "NetCDF Classic Format Specification" (CDF-1, CDF-2, CDF-5).

#include "ooc/result.h"
#include "terrain/raster_file.h"

namespace cuesta {

/// @return nothing to say also of files that are not classic ones (netCDF-4 is HDF5).
/// @error corrupt: a count or length that the rest of the file has no room for.
Result<void> check_netcdf_header(const RasterFile& file);

}  // namespace cuesta
