#include "terrain/mosaic_parts.h"

#include "terrain/lattice_view.h"

namespace cuesta {
namespace {

constexpr int steps = 32;
/// A part that takes so much of the Earth's circumference is taken all around.
constexpr double most_of_the_earth = 0.75;

/// Ranges of columns and rows, not clipped.
struct Extent {
  double west = 0, east = 0, north = 0, south = 0;
};

/// Calls `f` with places over the whole rectangle, its corners among them.
template <class F>
void for_places(const MosaicLayer& layer, F&& f) {
  for (int r = 0; r <= steps; ++r) {
    for (int c = 0; c <= steps; ++c)
      f(double(layer.width - 1) * c / steps, double(layer.height - 1) * r / steps);
  }
}

/// Places of `i` that lie in or near `j`, and the other way round, as columns and rows of `i`.
void add_shared(std::span<const MosaicLayer> layers, std::uint32_t i, std::uint32_t j,
                std::vector<Extent>& shared) {
  const double ratio = row_spacing_m(layers[j]) / row_spacing_m(layers[i]);
  const double margin_i = part_margin * std::max(1.0, ratio),
               margin_j = part_margin * std::max(1.0, 1 / ratio);
  const auto view = [&](std::uint32_t k) {
    return LatticeView(layers, k, -0.5 * double(layers[k].columns_around - layers[k].width));
  };
  const auto is_in = [](PlanePoint p, const MosaicLayer& layer, double margin) {
    return p.x >= -margin && p.x <= double(layer.width) + margin && p.y >= -margin &&
           p.y <= double(layer.height) + margin;
  };
  const double step_x = double(layers[i].width) / steps + margin_i,
               step_y = double(layers[i].height) / steps + margin_i;
  const LatticeView from_i = view(i), from_j = view(j);
  for_places(layers[i], [&](double column, double row) {
    if (is_in(from_j.at(i, column, row), layers[j], margin_j))
      shared.push_back({column - step_x, column + step_x, row - step_y, row + step_y});
  });
  for_places(layers[j], [&](double column, double row) {
    const PlanePoint p = from_i.at(j, column, row);
    if (is_in(p, layers[i], margin_i))
      shared.push_back({p.x - margin_i, p.x + margin_i, p.y - margin_i, p.y + margin_i});
  });
}

LayerPart part_of(const MosaicLayer& layer, std::uint32_t number, std::vector<Extent> shared) {
  LayerPart part{.layer = number};
  if (shared.empty()) return part;
  double north = shared[0].north, south = shared[0].south, west = shared[0].west, east = shared[0].east;
  for (const Extent& e : shared) {
    north = std::min(north, e.north);
    south = std::max(south, e.south);
    west = std::min(west, e.west);
    east = std::max(east, e.east);
  }
  const auto row = [&](double r) { return std::clamp(r, 0.0, double(layer.height)); };
  part.row = static_cast<std::uint64_t>(row(std::floor(north)));
  part.height = static_cast<std::uint64_t>(row(std::ceil(south) + 1)) - part.row;
  if (layer.closes()) {  // after the widest gap between them
    std::ranges::sort(shared, {}, &Extent::west);
    const auto around = double(layer.columns_around);
    double reached = east - around, widest = 0;
    for (const Extent& e : shared) {
      if (e.west - reached > widest) {
        widest = e.west - reached;
        west = e.west;
      }
      reached = std::max(reached, e.east);
    }
    east = west + around - widest;
    if (west < 0) {
      west += around;
      east += around;
    }
  }
  const bool at_pole =
      (layer.north_pole && part.row == 0) || (layer.south_pole && part.row + part.height == layer.height);
  if (at_pole || (layer.closes() && east - west > most_of_the_earth * double(layer.columns_around))) {
    part.width = layer.width;
    part.is_closed = layer.closes();
    return part;
  }
  const double last = layer.closes() ? 2 * double(layer.width) : double(layer.width);
  part.column = static_cast<std::uint64_t>(std::clamp(std::floor(west), 0.0, last));
  part.width = static_cast<std::uint64_t>(std::clamp(std::ceil(east) + 1, 0.0, last)) - part.column;
  return part;
}

}  // namespace

std::vector<LayerPart> parts_near_others(std::span<const MosaicLayer> layers) {
  std::vector<LayerPart> parts;
  for (std::uint32_t i = 0; i < layers.size(); ++i) {
    std::vector<Extent> shared;
    for (std::uint32_t j = 0; j < layers.size(); ++j) {
      if (i != j) add_shared(layers, i, j, shared);
    }
    parts.push_back(part_of(layers[i], i, std::move(shared)));
  }
  return parts;
}

}  // namespace cuesta
