#pragma once
/// TIFFs for tests, written by libtiff.

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "terrain/raster_info.h"

namespace cuesta::test {

struct TiffRecipe {
  std::uint32_t width = 37, height = 29;
  SampleType type = SampleType::i16;
  std::uint16_t compression = 1;  ///< COMPRESSION_NONE
  std::uint16_t predictor = 1;
  std::uint32_t tile = 0;  ///< side of tiles; 0: strips
  std::uint32_t rows_per_strip = 4;
  bool big_endian = false, big_tiff = false;
  std::string no_data = {};
  std::string metadata = {};
  std::vector<double> tie_points = {}, pixel_scale = {}, transformation = {};
  std::vector<std::uint16_t> geo_keys = {};
  std::vector<double> geo_doubles = {};
  std::string geo_ascii = {};
  std::uint16_t channels = 1;
  bool leave_out_last_tile = false;
};

/// Writes the heights (width · height) as samples of the recipe's type; a failure is a test failure.
void write_tiff(const std::filesystem::path& path, const TiffRecipe& recipe,
                const std::vector<double>& heights);

}  // namespace cuesta::test
