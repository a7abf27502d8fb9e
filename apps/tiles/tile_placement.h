#pragma once
/// Where a tileset is: its own axes, in which numbers are small, and where they are on the Earth.

#include <array>
#include <optional>

#include "hierarchy/directory.h"
#include "terrain/terrain_metadata.h"

namespace cuesta::tiles {

/// Local coordinates are metres or the file's units, z up or along ECEF's axes. On a lattice of the file's
/// step they are whole numbers: those of the file's grid, but for terrain in a projection, whose vertices are
/// brought onto the Earth one by one.
class TilePlacement {
 public:
  TilePlacement(const Directory& directory, const std::optional<TerrainFacts>& facts);

  /// Of a vertex at these grid coordinates, in units of step().
  Vec3i lattice(Vec3i grid_position) const;
  Vec3d local(Vec3i grid_position) const { return zero_ + vec_cast<double>(lattice(grid_position)) * step(); }
  double step() const { return grid_.step; }
  Vec3d lattice_zero() const { return zero_; }  ///< in local coordinates
  /// Whether lattice() bends straight lines, by up to edge² / 8 R, R the Earth's radius.
  bool bends() const { return bent_.has_value(); }

  /// Whether the tileset is at its place on the Earth.
  bool on_earth() const { return on_earth_; }
  /// Local coordinates to ECEF, or to the file's: column-major, as 3D Tiles has it.
  const std::array<double, 16>& transform() const { return transform_; }
  /// @pre on_earth()
  Geodetic geodetic(Vec3i grid_position) const { return frame_.geodetic(grid_.world(grid_position)); }

 private:
  void put_axes(const Frame& local);

  Grid grid_;
  Frame frame_ = Frame::ecef();
  bool on_earth_ = false;
  std::optional<Frame> bent_;  // a local frame for a projection
  Vec3d zero_;
  std::array<double, 16> transform_{1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1};
};

}  // namespace cuesta::tiles
