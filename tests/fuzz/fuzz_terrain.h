#pragma once
/// A libFuzzer target for rasters of heights: FUZZ_RASTER("a.tif", options). The name gives the format where
/// the content does not. A raster that opens is read in its first and last corner; all it gives must be
/// finite or NaN.

#include <algorithm>
#include <cmath>
#include <vector>

#include "tests/terrain/memory_file.h"

namespace cuesta::fuzz {

inline void read_corner(const HeightRaster& raster, bool last) {
  const RasterInfo& info = raster.info();
  const std::uint64_t width = std::min<std::uint64_t>(info.width, 200);
  const std::uint64_t height = std::min<std::uint64_t>(info.height, 200);
  std::vector<double> heights(width * height);
  const Window window{last ? info.width - width : 0, last ? info.height - height : 0, width, height};
  const auto read = raster.read(window, heights);
  if (!read && read.error().message.empty()) std::abort();
  if (read && std::any_of(heights.begin(), heights.end(), [](double h) { return std::isinf(h); }))
    std::abort();
}

inline int run_raster(const char* name, RasterOptions options, const std::uint8_t* data, std::size_t size) {
  options.cache_bytes = 1 << 16;
  const auto raster =
      open_raster(test::memory_file(name, {reinterpret_cast<const char*>(data), size}), options);
  if (!raster) {
    if (raster.error().message.empty()) std::abort();
    return 0;
  }
  read_corner(**raster, false);
  read_corner(**raster, true);
  return 0;
}

}  // namespace cuesta::fuzz

#define FUZZ_RASTER(name, ...)                                                             \
  extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {      \
    return cuesta::fuzz::run_raster(name, cuesta::RasterOptions{__VA_ARGS__}, data, size); \
  }
