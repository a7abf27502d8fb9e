#pragma once
/// Colours of heights for contents of terrain that has none of its own, those of Shading::relief: clients
/// light them themselves.

#include "apps/tiles/tile_mesh.h"
#include "hierarchy/directory.h"
#include "terrain/terrain_metadata.h"

namespace cuesta::tiles {

class HeightTint {
 public:
  HeightTint(const TerrainFacts& facts, const Grid& grid);

  /// sRGB, opaque: blue at and below the sea, then green, ochre and brown to rock and snow.
  Rgba8 colour(double height_m) const;
  /// Gives all vertices the colours of their heights.   @cost 0.5 µs per vertex of a frame of the globe
  void put(TileMesh& mesh) const;

 private:
  double height_m(const DrawVertex& v) const;

  Frame frame_;
  Grid grid_;
  double sea_level_m_, shore_m_, sea_floor_m_, land_least_m_, land_most_m_;  // but the level: above the sea
};

}  // namespace cuesta::tiles
