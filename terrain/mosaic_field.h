#pragma once
/// Heights of a mosaic's layers as files give them: put together, in one datum, filled, and under water.

#include "terrain/mosaic_layers.h"
#include "terrain/open_rasters.h"

namespace cuesta {

/// What is done with a file's heights.
enum class DatumStep : std::int8_t { add_undulation = 1, none = 0, subtract_undulation = -1 };

class MosaicField {
 public:
  MosaicField(const MosaicOptions& options, OpenRasters::Limits limits)
      : geoid_(options.geoid),
        sea_level_m_(options.sea_level_m),
        reach_(options.fill_postings),
        rasters_(options.raster, limits) {}

  /// First: adds the files.
  OpenRasters& rasters() { return rasters_; }
  const OpenRasters& rasters() const { return rasters_; }
  /// Second: where they lie, what is done with the heights of each, and the datum that results.
  /// Reads rows that lie at a pole.
  Result<void> place(MosaicLayers layers, std::vector<DatumStep> steps, VerticalDatum datum);

  const std::vector<MosaicLayer>& layers() const { return placed_.layers; }
  const std::vector<FilePlace>& places() const { return placed_.places; }
  const MosaicLayers& placed() const { return placed_; }
  std::uint32_t fill_reach() const { return reach_; }  ///< postings
  VerticalDatum datum() const { return datum_; }

  /// Whether the window holds postings of files, or such as may be filled. @pre as of read()
  bool has_files(std::uint32_t layer, const Window& window) const;
  /// As Mosaic::read(), as if there were no other layers. @pre the window lies in the layer.
  Result<void> read(std::uint32_t layer, const Window& window, std::span<double> heights,
                    MosaicCounts& counts) const;

 private:
  /// A window whose columns may be negative, or beyond the Earth's circumference.
  struct Reach {
    std::int64_t column = 0;
    std::uint64_t row = 0, width = 0, height = 0;
  };
  struct PoleHeights {
    double north = 0, south = 0;
  };
  Result<void> read_files(std::uint32_t layer, const Reach& reach, std::span<double> heights,
                          std::span<char> in_file) const;
  Result<void> read_image(std::uint32_t file, std::int64_t column, const Reach& reach,
                          std::span<double> heights, std::span<char> in_file) const;
  Result<void> read_turned(std::uint32_t file, const Window& turned, std::span<double> heights) const;
  Result<void> fill(std::uint32_t layer, const Reach& reach, std::span<double> heights,
                    MosaicCounts& counts) const;
  void flood(std::uint32_t layer, const Reach& reach, std::span<const char> in_file,
             std::span<double> heights, MosaicCounts& counts) const;
  bool has_file_below(std::uint32_t layer, std::int64_t column, std::uint64_t row) const;
  void add_undulations(const MosaicLayer& layer, std::int64_t column, std::uint64_t row, double sign,
                       std::span<double> heights) const;
  Result<double> pole_height(std::uint32_t layer, std::uint64_t row) const;
  void set_poles(std::uint32_t layer, const Reach& reach, std::span<double> heights) const;

  const Geoid* geoid_;
  std::optional<double> sea_level_m_;
  std::uint32_t reach_;
  OpenRasters rasters_;
  MosaicLayers placed_;
  std::vector<DatumStep> steps_;  // of each file
  VerticalDatum datum_ = VerticalDatum::unknown;
  std::vector<PoleHeights> poles_;  // of each layer
};

}  // namespace cuesta
