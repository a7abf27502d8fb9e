#pragma once
/// Where the postings of raster files are in the world of a .cuesta file: from the files themselves, without
/// what the build makes of them.

#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "apps/measure/vertical_error.h"
#include "ooc/result.h"
#include "terrain/frame.h"
#include "terrain/geoid.h"
#include "terrain/height_raster.h"

namespace cuesta::bench {

using Rasters = std::vector<std::unique_ptr<HeightRaster>>;

/// @error of open_height_raster().
Result<Rasters> open_rasters(std::span<const std::string> paths);

/// Threads: const calls are concurrent. Refers to the rasters.
class TerrainWorld {
 public:
  /// x and y as in the rasters' own systems, z the height.
  static TerrainWorld plane(const Rasters& rasters);

  /// The frame and the kind of heights that the file's metadata tell; without a word there, plane().
  /// @param geoid     name or file, for heights of the other kind than the file's; empty: the one the
  /// metadata name.
  /// @error of the metadata, of reference systems that are not known, of geoids that are not there.
  static Result<TerrainWorld> of(std::string_view metadata, const Rasters& rasters, const std::string& geoid);

  /// In world metres; NaN where there is no height.
  Vec3d position_m(std::size_t raster, double column, double row, double height_m) const;

  /// Empty in a plane.
  measure::UpAt up() const;

  /// Calls visit() with the postings of whole rows, some millions at a time: all of them need not fit in
  /// memory. NaN, too, are those that no triangle can have: in each cell two of the other corners or more are
  /// no data.
  /// @error of HeightRaster::read().
  Result<void> visit_postings(const std::function<void(std::span<const Vec3d>)>& visit) const;

 private:
  struct Source {
    const HeightRaster* raster;
    std::optional<Crs> crs;
    int undulations = 0;  ///< to be added: 1, 0 or -1
  };
  std::vector<Source> sources_;
  std::optional<Frame> frame_;
  std::shared_ptr<const Geoid> geoid_;  // shared: copies of a world go to visitors
};

}  // namespace cuesta::bench
