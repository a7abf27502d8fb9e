#pragma once
/// How space is divided into tiles: a rectangle of the globe by meridians and parallels, or a box by planes.
/// Each tile's longer sides are halved, so a tile has two to eight children.

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "hierarchy/directory.h"
#include "runtime/surface_part.h"
#include "terrain/terrain_metadata.h"

namespace cuesta::tiles {

/// Along the axes of a tree: longitude and latitude in degrees, or x, y and z in grid units.
struct TileRange {
  std::array<double, 3> lo{}, hi{};
  double size(std::size_t axis) const { return hi[axis] - lo[axis]; }
};

class TileTree {
 public:
  /// @param facts  of a terrain: it is divided along the ground only.
  TileTree(const Directory& directory, const std::optional<TerrainFacts>& facts);

  /// Ranges are of longitude and latitude: the file is a terrain on the globe, and says where.
  bool on_globe() const { return frame_.has_value(); }
  std::size_t axes() const { return axes_; }
  const TileRange& root() const { return root_; }
  /// A digit per level, each with a bit set for each axis of which the tile is in the upper half.
  /// @return nothing for a path that is not in the tree.
  std::optional<TileRange> range(const std::string& path) const;
  /// The digits of the children; none where the tile is too small to be halved: a few steps of the grid, or
  /// of a degree.
  std::vector<char> children(const TileRange& range) const;

  /// The borders of a tile; what lies around the root has none.
  SurfacePart part(const TileRange& range) const;

 private:
  unsigned halved(const TileRange& range) const;
  TileRange half(TileRange range, unsigned halved, unsigned upper) const;
  PartBorder border(std::size_t axis, bool upper, double at) const;

  std::optional<Frame> frame_;
  Grid grid_;
  std::size_t axes_;
  TileRange root_;
};

}  // namespace cuesta::tiles
