#include "terrain/mosaic_field.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "ooc/read_job.h"
#include "terrain/fill_postings.h"
#include "terrain/lattice_view.h"

namespace cuesta {
namespace {

constexpr double nan = std::numeric_limits<double>::quiet_NaN();
/// Postings of a row at a pole that are read at once.
constexpr std::uint64_t pole_piece = std::uint64_t{1} << 16;

/// What [begin, begin + count) shares with another range, counted from its own begin.
struct Overlap {
  std::uint64_t begin = 0, count = 0;
};
Overlap overlap(std::int64_t begin, std::uint64_t count, std::int64_t other, std::uint64_t other_count) {
  const std::int64_t from = std::max(begin, other);
  const std::int64_t to =
      std::min(begin + static_cast<std::int64_t>(count), other + static_cast<std::int64_t>(other_count));
  if (from >= to) return {};
  return {static_cast<std::uint64_t>(from - begin), static_cast<std::uint64_t>(to - from)};
}

std::int64_t floor_div(std::int64_t a, std::int64_t b) {
  return a / b - (a % b < 0 ? 1 : 0);
}

}  // namespace

Result<void> MosaicField::place(MosaicLayers layers, std::vector<DatumStep> steps, VerticalDatum datum) {
  placed_ = std::move(layers);
  steps_ = std::move(steps);
  datum_ = datum;
  poles_.resize(placed_.layers.size());
  for (std::uint32_t i = 0; i < placed_.layers.size(); ++i) {
    const MosaicLayer& layer = placed_.layers[i];
    if (layer.north_pole) {
      const auto height = pole_height(i, 0);
      if (!height) return fail(height.error());
      poles_[i].north = *height;
    }
    if (layer.south_pole) {
      const auto height = pole_height(i, layer.height - 1);
      if (!height) return fail(height.error());
      poles_[i].south = *height;
    }
  }
  return {};
}

Result<void> MosaicField::read(std::uint32_t layer, const Window& window, std::span<double> heights,
                               MosaicCounts& counts) const {
  const Reach reach{static_cast<std::int64_t>(window.column), window.row, window.width, window.height};
  std::vector<char> in_file(sea_level_m_ ? heights.size() : 0);
  CUESTA_TRY(read_files(layer, reach, heights, in_file));
  if (reach_ > 0) CUESTA_TRY(fill(layer, reach, heights, counts));
  if (sea_level_m_) flood(layer, reach, in_file, heights, counts);
  set_poles(layer, reach, heights);
  return {};
}

bool MosaicField::has_files(std::uint32_t layer, const Window& window) const {
  const auto around = static_cast<std::int64_t>(placed_.layers[layer].columns_around);
  const auto west = static_cast<std::int64_t>(window.column) - std::int64_t{reach_};
  const std::uint64_t width = window.width + 2 * std::uint64_t{reach_};
  const auto north = static_cast<std::int64_t>(window.row) - std::int64_t{reach_};
  const std::uint64_t height = window.height + 2 * std::uint64_t{reach_};
  return std::ranges::any_of(placed_.layers[layer].files, [&](std::uint32_t file) {
    const FilePlace& place = placed_.places[file];
    if (overlap(north, height, static_cast<std::int64_t>(place.row), place.turn.height).count == 0)
      return false;
    auto column = static_cast<std::int64_t>(place.column);
    if (around > 0)
      column += floor_div(west + static_cast<std::int64_t>(width) - 1 - column, around) * around;
    return overlap(west, width, column, place.turn.width).count > 0;
  });
}

/// Files by falling priority, each where none before it has data.
/// @param in_file  set to 1 where a posting belongs to a file, with data or without; may be empty.
Result<void> MosaicField::read_files(std::uint32_t layer_number, const Reach& reach,
                                     std::span<double> heights, std::span<char> in_file) const {
  const MosaicLayer& layer = placed_.layers[layer_number];
  const auto around = static_cast<std::int64_t>(layer.columns_around);
  std::ranges::fill(heights, nan);
  for (const std::uint32_t file : layer.files) {
    const FilePlace& place = placed_.places[file];
    const Overlap rows = overlap(static_cast<std::int64_t>(reach.row), reach.height,
                                 static_cast<std::int64_t>(place.row), place.turn.height);
    if (rows.count == 0) continue;
    auto column = static_cast<std::int64_t>(place.column);
    if (around == 0) {
      CUESTA_TRY(read_image(file, column, reach, heights, in_file));
      continue;
    }
    // The file is there every 360°. From the east: of one that laps over itself its first columns win.
    const std::int64_t last = reach.column + static_cast<std::int64_t>(reach.width) - 1;
    const auto width = static_cast<std::int64_t>(place.turn.width);
    for (column += floor_div(last - column, around) * around; column + width > reach.column; column -= around)
      CUESTA_TRY(read_image(file, column, reach, heights, in_file));
  }
  return {};
}

/// The part of a file in the reach, where the file's first column is `column`.
Result<void> MosaicField::read_image(std::uint32_t file, std::int64_t column, const Reach& reach,
                                     std::span<double> heights, std::span<char> in_file) const {
  const FilePlace& place = placed_.places[file];
  const Overlap columns = overlap(reach.column, reach.width, column, place.turn.width);
  const Overlap rows = overlap(static_cast<std::int64_t>(reach.row), reach.height,
                               static_cast<std::int64_t>(place.row), place.turn.height);
  bool is_wanted = false;
  for (std::uint64_t r = rows.begin; r < rows.begin + rows.count; ++r) {
    const std::uint64_t first = r * reach.width + columns.begin;
    const auto row = heights.subspan(first, columns.count);
    is_wanted = is_wanted || std::ranges::any_of(row, [](double height) { return std::isnan(height); });
    if (!in_file.empty()) std::ranges::fill(in_file.subspan(first, columns.count), char{1});
  }
  if (!is_wanted) return {};
  const std::int64_t first = reach.column + static_cast<std::int64_t>(columns.begin) - column;
  const Window turned{static_cast<std::uint64_t>(first), reach.row + rows.begin - place.row, columns.count,
                      rows.count};
  std::vector<double> piece(turned.width * turned.height);
  CUESTA_TRY(read_turned(file, turned, piece));
  for (std::uint64_t r = 0; r < rows.count; ++r) {
    for (std::uint64_t c = 0; c < columns.count; ++c) {
      double& height = heights[(rows.begin + r) * reach.width + columns.begin + c];
      if (std::isnan(height)) height = piece[r * columns.count + c];
    }
  }
  return {};
}

/// A window of a turned file, in the mosaic's datum.
Result<void> MosaicField::read_turned(std::uint32_t file, const Window& turned,
                                      std::span<double> heights) const {
  const FilePlace& place = placed_.places[file];
  if (place.turn.is_identity()) {
    CUESTA_TRY(rasters_.read(file, turned, heights));
  } else {
    std::vector<double> of_file(heights.size());
    CUESTA_TRY(rasters_.read(file, place.turn.file_window(turned), of_file));
    place.turn.turn(turned, of_file, heights);
  }
  if (steps_[file] == DatumStep::none) return {};
  for (std::uint64_t r = 0; r < turned.height; ++r) {
    add_undulations(placed_.layers[place.layer], static_cast<std::int64_t>(place.column + turned.column),
                    place.row + turned.row + r, double(steps_[file]),
                    heights.subspan(r * turned.width, turned.width));
  }
  return {};
}

/// Adds the geoid's undulations, times `sign`, along a row of postings.
void MosaicField::add_undulations(const MosaicLayer& layer, std::int64_t column, std::uint64_t row,
                                  double sign, std::span<double> heights) const {
  std::vector<LatLon> at(heights.size());
  std::vector<double> undulations_m(heights.size());
  for (std::size_t i = 0; i < heights.size(); ++i) {
    const double c = double(column) + double(i);
    at[i] = layer.crs.lat_lon({layer.map.x(c, double(row)), layer.map.y(c, double(row))});
  }
  geoid_->undulations_m(at, undulations_m);
  for (std::size_t i = 0; i < heights.size(); ++i) heights[i] += sign * undulations_m[i];
}

Result<void> MosaicField::fill(std::uint32_t layer_number, const Reach& reach, std::span<double> heights,
                               MosaicCounts& counts) const {
  if (std::ranges::none_of(heights, [](double height) { return std::isnan(height); })) return {};
  const MosaicLayer& layer = placed_.layers[layer_number];
  FieldBorder border{.west = reach_, .east = reach_};
  if (layer.columns_around == 0) {
    const auto column = static_cast<std::uint64_t>(reach.column);
    border.west = std::min(border.west, column);
    border.east = std::min(border.east, layer.width - column - reach.width);
  }
  border.north = std::min<std::uint64_t>(reach_, reach.row);
  border.south = std::min<std::uint64_t>(reach_, layer.height - reach.row - reach.height);
  const Reach larger{reach.column - static_cast<std::int64_t>(border.west), reach.row - border.north,
                     reach.width + border.west + border.east, reach.height + border.north + border.south};
  std::vector<double> field(larger.width * larger.height);
  CUESTA_TRY(read_files(layer_number, larger, field, {}));
  counts.filled += fill_postings(field, larger.width, larger.height, border, reach_, heights);
  return {};
}

/// Whether a file of a layer of less priority lies there: that layer then tells what is there, if it is
/// water.
bool MosaicField::has_file_below(std::uint32_t layer, std::int64_t column, std::uint64_t row) const {
  for (std::uint32_t below = layer + 1; below < placed_.layers.size(); ++below) {
    const MosaicLayer& other = placed_.layers[below];
    const LatticeView view(placed_.layers, below, 0);
    const PlanePoint p = view.at(layer, double(column), double(row));
    for (const std::uint32_t file : other.files) {
      const FilePlace& place = placed_.places[file];
      double east = p.x - double(place.column);
      if (const auto around = double(other.columns_around); around > 0)
        east -= around * std::floor(east / around);
      const double south = p.y - double(place.row);
      if (east >= 0 && east <= double(place.turn.width - 1) && south >= 0 &&
          south <= double(place.turn.height - 1))
        return true;
    }
  }
  return false;
}

void MosaicField::flood(std::uint32_t layer, const Reach& reach, std::span<const char> in_file,
                        std::span<double> heights, MosaicCounts& counts) const {
  // Water is level above the geoid.
  const bool is_above_geoid = geoid_ && datum_ == VerticalDatum::ellipsoidal;
  std::vector<double> surface(reach.width);
  for (std::uint64_t r = 0; r < reach.height; ++r) {
    std::ranges::fill(surface, *sea_level_m_);
    if (is_above_geoid) add_undulations(placed_.layers[layer], reach.column, reach.row + r, 1, surface);
    for (std::uint64_t c = 0; c < reach.width; ++c) {
      double& height = heights[r * reach.width + c];
      if (std::isnan(height)) {
        if (in_file[r * reach.width + c] == 0 || std::isnan(surface[c])) continue;
        if (has_file_below(layer, reach.column + static_cast<std::int64_t>(c), reach.row + r)) continue;
        ++counts.flooded;
        height = surface[c];
      } else if (height < surface[c]) {
        ++counts.raised;
        height = surface[c];
      }
    }
  }
}

/// Mean of the row's data, above water.
Result<double> MosaicField::pole_height(std::uint32_t layer_number, std::uint64_t row) const {
  const MosaicLayer& layer = placed_.layers[layer_number];
  double sum = 0;
  std::uint64_t count = 0;
  bool is_water = false;
  std::vector<double> heights;
  std::vector<char> in_file;
  for (std::uint64_t column = 0; column < layer.width; column += pole_piece) {
    const Reach reach{static_cast<std::int64_t>(column), row, std::min(pole_piece, layer.width - column), 1};
    heights.resize(reach.width);
    in_file.assign(reach.width, 0);
    CUESTA_TRY(read_files(layer_number, reach, heights, in_file));
    for (std::uint64_t i = 0; i < reach.width; ++i) {
      is_water = is_water || in_file[i] != 0;
      if (std::isnan(heights[i])) continue;
      sum += heights[i];
      ++count;
    }
  }
  double height = count > 0 ? sum / double(count) : nan;
  MosaicCounts ignored;
  if (sea_level_m_)
    flood(layer_number, {0, row, 1, 1}, std::array{static_cast<char>(is_water)}, {&height, 1}, ignored);
  return height;
}

void MosaicField::set_poles(std::uint32_t layer_number, const Reach& reach, std::span<double> heights) const {
  const MosaicLayer& layer = placed_.layers[layer_number];
  if (layer.north_pole && reach.row == 0)
    std::ranges::fill(heights.first(reach.width), poles_[layer_number].north);
  if (layer.south_pole && reach.row + reach.height == layer.height)
    std::ranges::fill(heights.last(reach.width), poles_[layer_number].south);
}

}  // namespace cuesta
