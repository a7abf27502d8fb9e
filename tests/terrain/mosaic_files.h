#pragma once
/// Small grids in files, and the mosaics of them.

#include <fmt/format.h>

#include "terrain/mosaic.h"
#include "tests/terrain/raster_files.h"

namespace cuesta::test {

inline const double none = std::nan("");
using Paths = std::vector<std::filesystem::path>;

/// An ESRI ASCII grid of one spacing, by its upper left posting; NaN is no data.
inline std::string grid(double x, double y, double spacing, std::uint64_t width,
                        const std::vector<double>& heights) {
  const std::uint64_t rows = heights.size() / width;
  std::string text = fmt::format("ncols {}\nnrows {}\nxllcenter {}\nyllcenter {}\ncellsize {}\n", width, rows,
                                 x, y - double(rows - 1) * spacing, spacing);
  for (std::size_t i = 0; i < heights.size(); ++i)
    text +=
        (std::isnan(heights[i]) ? "-9999" : fmt::format("{}", heights[i])) + ((i + 1) % width ? " " : "\n");
  return text;
}

inline MosaicOptions degrees() {
  MosaicOptions options;
  options.raster.epsg = 4326;
  return options;
}

/// A mosaic that must be good.
inline std::optional<Mosaic> open_mosaic(const Paths& files, const MosaicOptions& options = {}) {
  auto mosaic = Mosaic::open(files, options);
  if (mosaic) return std::move(*mosaic);
  ADD_FAILURE() << mosaic.error().text();
  return std::nullopt;
}

inline Error mosaic_error(const Paths& files, const MosaicOptions& options = {}) {
  const auto mosaic = Mosaic::open(files, options);
  if (!mosaic) return mosaic.error();
  ADD_FAILURE() << "was opened, expected an error";
  return {};
}

inline std::vector<double> read_mosaic(const Mosaic& mosaic, std::uint32_t layer, const Window& window,
                                       MosaicCounts* counts = nullptr) {
  std::vector<double> heights(window.width * window.height);
  const auto read = mosaic.read(layer, window, heights, counts);
  if (!read) ADD_FAILURE() << read.error().text();
  return heights;
}

inline std::vector<double> whole_mosaic(const Mosaic& mosaic, std::uint32_t layer = 0,
                                        MosaicCounts* counts = nullptr) {
  const MosaicLayer& l = mosaic.layers()[layer];
  return read_mosaic(mosaic, layer, {0, 0, l.width, l.height}, counts);
}

inline void expect_same_heights(const std::vector<double>& found, const std::vector<double>& expected) {
  ASSERT_EQ(found.size(), expected.size());
  for (std::size_t i = 0; i < found.size(); ++i)
    ASSERT_TRUE(same(found[i], expected[i])) << i << ": " << found[i] << ", expected " << expected[i];
}

}  // namespace cuesta::test
