#include "terrain/mosaic_parts.h"

#include "terrain/lattice_view.h"

namespace cuesta {
namespace {

constexpr int steps = 32;
/// A part that takes so much of the Earth's circumference is taken all around.
constexpr double most_of_the_earth = 0.75;
/// With more pairs of groups of two layers, all of one layer's groups are taken as one.
constexpr std::size_t most_pairs = 4096;

/// Ranges of columns and rows, not clipped.
struct Extent {
  double west = 0, east = 0, north = 0, south = 0;

  bool meets(const Extent& other) const {
    return west <= other.east && other.west <= east && north <= other.south && other.north <= south;
  }
  bool contains(PlanePoint p) const { return p.x >= west && p.x <= east && p.y >= north && p.y <= south; }
  Extent grown(double margin) const { return {west - margin, east + margin, north - margin, south + margin}; }
  Extent joined(const Extent& other) const {
    return {std::min(west, other.west), std::max(east, other.east), std::min(north, other.north),
            std::max(south, other.south)};
  }
  Extent clipped(const Extent& to) const {
    return {std::max(west, to.west), std::min(east, to.east), std::max(north, to.north),
            std::min(south, to.south)};
  }
};

Extent whole(const MosaicLayer& layer) {
  return {0, double(layer.width), 0, double(layer.height)};
}

/// Boxes of files, those that come within `gap` of each other in one. Of a layer that closes one is all of
/// it.
std::vector<Extent> groups_of(const MosaicLayers& mosaic, std::uint32_t number, double gap) {
  const MosaicLayer& layer = mosaic.layers[number];
  if (layer.closes()) return {whole(layer)};
  std::vector<Extent> groups;
  for (const std::uint32_t file : layer.files) {
    const FilePlace& place = mosaic.places[file];
    const double column = double(place.column), row = double(place.row);
    Extent group{column, column + double(place.turn.width), row, row + double(place.turn.height)};
    for (std::size_t i = 0; i < groups.size();) {
      if (!group.grown(gap).meets(groups[i])) {
        ++i;
        continue;
      }
      group = group.joined(groups[i]);
      groups[i] = groups.back();
      groups.pop_back();
      i = 0;  // it is larger now
    }
    groups.push_back(group);
  }
  return groups;
}

/// Calls `f` with places over the whole box, its corners among them.
template <class F>
void for_places(const Extent& box, F&& f) {
  for (int r = 0; r <= steps; ++r) {
    for (int c = 0; c <= steps; ++c)
      f(box.west + (box.east - 1 - box.west) * c / steps,
        box.north + (box.south - 1 - box.north) * r / steps);
  }
}

struct Group {
  std::uint32_t layer = 0;
  Extent box;
};

/// Places of `i` that lie in or near `j`, and the other way round, as columns and rows of `i`.
void add_shared(std::span<const MosaicLayer> layers, const Group& i, const Group& j,
                std::vector<Extent>& shared) {
  const double ratio = row_spacing_m(layers[j.layer]) / row_spacing_m(layers[i.layer]);
  const double margin_i = part_margin * std::max(1.0, ratio),
               margin_j = part_margin * std::max(1.0, 1 / ratio);
  const auto view = [&](std::uint32_t k) {
    const MosaicLayer& layer = layers[k];
    const double beyond = layer.columns_around == 0 ? 0 : 0.5 * double(layer.columns_around - layer.width);
    return LatticeView(layers, k, -beyond);
  };
  const double step_x = (i.box.east - i.box.west) / steps + margin_i;
  const double step_y = (i.box.south - i.box.north) / steps + margin_i;
  const LatticeView from_i = view(i.layer), from_j = view(j.layer);
  const Extent near_i = i.box.grown(margin_i), near_j = j.box.grown(margin_j);
  for_places(i.box, [&](double column, double row) {
    if (near_j.contains(from_j.at(i.layer, column, row)))
      shared.push_back({column - step_x, column + step_x, row - step_y, row + step_y});
  });
  for_places(j.box, [&](double column, double row) {
    const PlanePoint p = from_i.at(j.layer, column, row);
    if (near_i.contains(p))
      shared.push_back({p.x - margin_i, p.x + margin_i, p.y - margin_i, p.y + margin_i});
  });
}

/// Of a layer that closes: from west to east after the widest gap between the extents.
void set_arc(std::vector<Extent> shared, double around, Extent& box) {
  std::ranges::sort(shared, {}, &Extent::west);
  double reached = box.east - around, widest = 0;
  for (const Extent& e : shared) {
    if (e.west - reached > widest) {
      widest = e.west - reached;
      box.west = e.west;
    }
    reached = std::max(reached, e.east);
  }
  box.east = box.west + around - widest;
  const double turns = std::floor(box.west / around);
  box.west -= turns * around;
  box.east -= turns * around;
}

LayerPart part_of(const MosaicLayer& layer, const Group& group, const std::vector<Extent>& shared) {
  LayerPart part{.layer = group.layer};
  if (shared.empty()) return part;
  Extent box = shared.front();
  for (const Extent& e : shared) box = box.joined(e);
  if (layer.closes())
    set_arc(shared, double(layer.columns_around), box);
  else
    box = box.clipped(group.box);
  const auto row = [&](double r) {
    return static_cast<std::uint64_t>(std::clamp(r, 0.0, double(layer.height)));
  };
  part.row = row(std::floor(box.north));
  part.height = row(std::ceil(box.south) + 1) - part.row;
  const bool at_pole =
      (layer.north_pole && part.row == 0) || (layer.south_pole && part.row + part.height == layer.height);
  if (at_pole || (layer.closes() && box.east - box.west > most_of_the_earth * double(layer.columns_around))) {
    part.width = layer.width;
    part.is_closed = layer.closes();
    return part;
  }
  const double last = layer.closes() ? 2 * double(layer.width) : double(layer.width);
  part.column = static_cast<std::uint64_t>(std::clamp(std::floor(box.west), 0.0, last));
  part.width = static_cast<std::uint64_t>(std::clamp(std::ceil(box.east) + 1, 0.0, last)) - part.column;
  return part;
}

}  // namespace

std::vector<LayerPart> parts_near_others(const MosaicLayers& mosaic, std::uint64_t gap) {
  const auto layers = static_cast<std::uint32_t>(mosaic.layers.size());
  std::vector<std::vector<Extent>> groups;
  for (std::uint32_t i = 0; i < layers; ++i) groups.push_back(groups_of(mosaic, i, double(gap)));
  std::vector<LayerPart> parts;
  for (std::uint32_t i = 0; i < layers; ++i) {
    for (const Extent& box : groups[i]) {
      const Group group{i, box};
      std::vector<Extent> shared;
      for (std::uint32_t j = 0; j < layers; ++j) {
        if (i == j) continue;
        if (groups[i].size() * groups[j].size() > most_pairs) {
          add_shared(mosaic.layers, group, {j, whole(mosaic.layers[j])}, shared);
          continue;
        }
        for (const Extent& other : groups[j]) add_shared(mosaic.layers, group, {j, other}, shared);
      }
      const LayerPart part = part_of(mosaic.layers[i], group, shared);
      if (part.width > 0 && part.height > 0) parts.push_back(part);
    }
  }
  return parts;
}

}  // namespace cuesta
