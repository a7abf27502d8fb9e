#pragma once
/// Which surface of a volume to read. Files that are meshes already ignore it.

#include <cstdint>
#include <optional>
#include <string>

namespace cuesta {

struct VolumeOptions {
  /// Of the file's grids; empty: the first that is a scalar grid of float, half or double.
  std::string grid = {};
  /// Value on the surface, in the grid's units. Unset: 0 for a level set, 0.5 for a fog volume; a grid of
  /// neither class needs one.
  std::optional<double> iso = {};
  /// 0 keeps every quad. Above 0, cells of one 8³ leaf node are merged while 1 - n·m of all their unit
  /// normals n, m is at most this; 1 merges whatever keeps the surface's topology.
  double adaptivity = 0;
  /// Edge of the block that is meshed at a time: a multiple of 8. Decides memory, not the surface.
  std::int32_t block_voxels = 128;
};

}  // namespace cuesta
