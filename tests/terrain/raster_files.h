#pragma once
/// Small rasters for tests, and what holds for every raster.

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "terrain/height_raster.h"
#include "tests/ooc/mesh_files.h"

namespace cuesta::test {

using Raster = std::unique_ptr<HeightRaster>;

inline Raster open_raster(const std::filesystem::path& path, const RasterOptions& options = {}) {
  auto raster = open_height_raster(path, options);
  if (raster) return std::move(*raster);
  ADD_FAILURE() << raster.error().text();
  return nullptr;
}

inline Error open_error(const std::filesystem::path& path, const RasterOptions& options = {}) {
  const auto raster = open_height_raster(path, options);
  if (!raster) return raster.error();
  ADD_FAILURE() << path << " was opened, expected an error";
  return {};
}

inline std::vector<double> window_of(const HeightRaster& raster, const Window& window) {
  std::vector<double> heights(window.width * window.height);
  const auto read = raster.read(window, heights);
  if (!read) ADD_FAILURE() << read.error().text();
  return heights;
}

inline std::vector<double> whole(const HeightRaster& raster) {
  return window_of(raster, {0, 0, raster.info().width, raster.info().height});
}

inline double height_at(const HeightRaster& raster, std::uint64_t column, std::uint64_t row) {
  return window_of(raster, {column, row, 1, 1}).front();
}

inline bool same(double a, double b) {
  return a == b || (std::isnan(a) && std::isnan(b));
}

inline void expect_heights(const HeightRaster& raster, const std::vector<double>& expected) {
  const std::vector<double> heights = whole(raster);
  ASSERT_EQ(heights.size(), expected.size());
  for (std::size_t i = 0; i < heights.size(); ++i) {
    ASSERT_TRUE(same(heights[i], expected[i]))
        << "posting " << i % raster.info().width << ", " << i / raster.info().width << ": " << heights[i]
        << ", expected " << expected[i];
  }
}

/// Windows at random, single rows, columns and postings among them, are what the whole has there.
inline void expect_windows_equal_whole(const HeightRaster& raster, unsigned windows = 30, unsigned seed = 1) {
  const std::vector<double> all = whole(raster);
  const std::uint64_t width = raster.info().width, height = raster.info().height;
  std::mt19937 random(seed);
  const auto below = [&](std::uint64_t n) {
    return std::uniform_int_distribution<std::uint64_t>(0, n - 1)(random);
  };
  for (unsigned i = 0; i < windows; ++i) {
    Window window{.column = below(width), .row = below(height)};
    window.width = i % 5 == 0 ? 1 : 1 + below(width - window.column);
    window.height = i % 5 == 1 ? 1 : 1 + below(height - window.row);
    const std::vector<double> part = window_of(raster, window);
    for (std::uint64_t k = 0; k < part.size(); ++k) {
      const std::uint64_t column = window.column + k % window.width, row = window.row + k / window.width;
      ASSERT_TRUE(same(part[k], all[row * width + column]))
          << "seed " << seed << ", window " << i << ", posting " << column << ", " << row;
    }
  }
}

/// Heights that differ everywhere and fit every type: below 113.
inline std::vector<double> ramp(std::uint64_t width, std::uint64_t height) {
  std::vector<double> out;
  for (std::uint64_t i = 0; i < width * height; ++i) out.push_back(double((i * 37 + i / width * 11) % 113));
  return out;
}

template <class T>
std::string packed(const std::vector<double>& heights, bool big_endian = false) {
  std::string out;
  for (const double height : heights) {
    const T value = static_cast<T>(height);
    std::string bytes(reinterpret_cast<const char*>(&value), sizeof(T));
    if (big_endian) std::reverse(bytes.begin(), bytes.end());
    out += bytes;
  }
  return out;
}

inline std::string file_bytes(const std::filesystem::path& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), {}};
}

}  // namespace cuesta::test
