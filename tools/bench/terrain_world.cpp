#include "tools/bench/terrain_world.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "terrain/crs_geokeys.h"
#include "terrain/terrain_metadata.h"

namespace cuesta::bench {
namespace {

constexpr std::uint64_t postings_at_once = std::uint64_t{1} << 23;

int undulations_to(VerticalDatum wanted, VerticalDatum own) {
  if (wanted == VerticalDatum::unknown || own == VerticalDatum::unknown || wanted == own) return 0;
  return wanted == VerticalDatum::ellipsoidal ? 1 : -1;
}

/// Whether a cell at the posting has heights at three of its corners.
bool has_triangle(std::span<const double> heights_m, std::uint64_t width, std::uint64_t column,
                  std::uint64_t row) {
  const auto columns = static_cast<std::int64_t>(width), rows = std::ssize(heights_m) / columns;
  const auto x = static_cast<std::int64_t>(column), y = static_cast<std::int64_t>(row);
  const auto known = [&](std::int64_t c, std::int64_t r) -> int {
    return c >= 0 && r >= 0 && c < columns && r < rows &&
           std::isfinite(heights_m[static_cast<std::size_t>(r * columns + c)]);
  };
  if (!known(x, y)) return false;
  for (const int right : {-1, 1})
    for (const int down : {-1, 1})
      if (known(x + right, y) + known(x, y + down) + known(x + right, y + down) >= 2) return true;
  return false;
}

}  // namespace

Result<Rasters> open_rasters(std::span<const std::string> paths) {
  Rasters rasters;
  for (const std::string& path : paths) {
    auto raster = open_height_raster(path);
    if (!raster) return fail(raster.error());
    rasters.push_back(std::move(*raster));
  }
  return rasters;
}

TerrainWorld TerrainWorld::plane(const Rasters& rasters) {
  TerrainWorld world;
  for (const auto& raster : rasters) world.sources_.push_back({.raster = raster.get(), .crs = {}});
  return world;
}

Result<TerrainWorld> TerrainWorld::of(std::string_view metadata, const Rasters& rasters,
                                      const std::string& geoid) {
  const auto facts = terrain_facts(metadata);
  if (!facts) return fail(facts.error());
  TerrainWorld world = plane(rasters);
  if (!*facts) return world;
  world.frame_ = (*facts)->frame;
  bool needs_geoid = false;
  for (Source& source : world.sources_) {
    const RasterInfo& info = source.raster->info();
    auto crs = info.is_placed ? crs_of(info.crs) : Result<Crs>(Crs::plane());
    if (!crs) return fail(crs.error());
    source.crs = std::move(*crs);
    source.undulations = undulations_to((*facts)->heights, info.vertical_datum);
    needs_geoid |= source.undulations != 0;
  }
  if (!needs_geoid) return world;
  auto opened = Geoid::open(geoid.empty() ? (*facts)->geoid : geoid);
  if (!opened) return fail(opened.error());
  world.geoid_ = std::make_shared<const Geoid>(std::move(*opened));
  return world;
}

Vec3d TerrainWorld::position_m(std::size_t raster, double column, double row, double height_m) const {
  const Source& source = sources_[raster];
  const PostingMap& map = source.raster->info().map;
  const PlanePoint p{map.x(column, row), map.y(column, row)};
  if (!frame_) return {p.x, p.y, height_m};
  if (source.undulations != 0) height_m += source.undulations * geoid_->undulation_m(source.crs->lat_lon(p));
  return frame_->position_m(*source.crs, p, height_m);
}

measure::UpAt TerrainWorld::up() const {
  if (!frame_ || frame_->kind() == FrameKind::projected) return {};
  return [frame = *frame_](Vec3d position_m) { return frame.up(position_m); };
}

Result<void> TerrainWorld::visit_postings(const std::function<void(std::span<const Vec3d>)>& visit) const {
  std::vector<double> heights_m;
  std::vector<Vec3d> postings;
  for (std::size_t s = 0; s < sources_.size(); ++s) {
    const std::uint64_t width = sources_[s].raster->info().width, height = sources_[s].raster->info().height;
    const std::uint64_t band = std::clamp<std::uint64_t>(postings_at_once / width, 1, height);
    for (std::uint64_t first = 0; first < height; first += band) {
      const std::uint64_t end = std::min(first + band, height);
      // And the rows before and after.
      const std::uint64_t top = first - std::min<std::uint64_t>(first, 1);
      const Window window{0, top, width, std::min(end + 1, height) - top};
      heights_m.resize(window.width * window.height);
      postings.resize((end - first) * width);
      if (auto r = sources_[s].raster->read(window, heights_m); !r) return r;
      tbb::parallel_for(tbb::blocked_range<std::size_t>(0, postings.size(), 4096), [&](const auto& range) {
        for (std::size_t i = range.begin(); i < range.end(); ++i) {
          const std::uint64_t column = i % width, row = first + i / width;
          const double height_m = has_triangle(heights_m, width, column, row - top)
                                      ? heights_m[(row - top) * width + column]
                                      : std::numeric_limits<double>::quiet_NaN();
          postings[i] = position_m(s, static_cast<double>(column), static_cast<double>(row), height_m);
        }
      });
      visit(postings);
    }
  }
  return {};
}

}  // namespace cuesta::bench
