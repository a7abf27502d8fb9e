#pragma once
/// A raster whose samples lie row by row in a file: read in place, without a cache.

#include <functional>
#include <memory>
#include <mutex>
#include <optional>

#include "terrain/height_raster.h"
#include "terrain/raster_file.h"

namespace cuesta {

/// How the samples lie: row r begins at header_bytes + r · width · bytes_of(type).
struct SampleLayout {
  std::uint64_t header_bytes = 0;
  SampleType type = SampleType::i16;
  ByteOrder order = ByteOrder::little;
};

/// @pre the file is long enough for info.width · info.height samples.
std::unique_ptr<HeightRaster> make_sample_raster(RasterInfo info, RasterFile file,
                                                 const SampleLayout& layout);

/// Makes the file on the first read: of formats that can be decoded only from front to back. A failure is
/// returned by that read, and tried again by the next.
using Unpack = std::function<Result<MappedFile>()>;
std::unique_ptr<HeightRaster> make_unpacked_raster(RasterInfo info, Unpack unpack,
                                                   const SampleLayout& layout);

/// @pre check_info() was good: it fits.
inline std::uint64_t sample_bytes(const RasterInfo& info, SampleType type) {
  return info.width * info.height * bytes_of(type);
}

}  // namespace cuesta
