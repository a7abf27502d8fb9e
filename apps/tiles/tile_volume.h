#pragma once
/// Bounding volumes of tiles, as 3D Tiles writes them. They hold a tile and all that is below it.

#include <vector>

#include "apps/tiles/tile_mesh.h"
#include "apps/tiles/tile_placement.h"
#include "apps/tiles/tile_tree.h"

namespace cuesta::tiles {

struct TileVolume {
  /// Region: west, south, east, north in radians, least and most height in metres. Else a box: its centre,
  /// then its half axes, in local coordinates.
  bool is_region = false;
  std::vector<double> numbers;
};

/// @param mesh    the tile's content, which gives a terrain's heights.
/// @param margin  how far outside of the range the content reaches, grid units.
/// @param error   the tile's geometric error: no descendant is higher or lower than the content by more than
/// `height_errors` of it.
TileVolume volume_of(const TileTree& tree, const TilePlacement& placement, const Grid& grid,
                     const TileRange& range, const TileMesh& mesh, double margin, double error);

/// A descendant of half the error or less, whose own heights are taken as widely, stays within these.
inline constexpr double height_errors = 4;

}  // namespace cuesta::tiles
