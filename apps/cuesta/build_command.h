#pragma once
/// cuesta build: mesh files, scenes or rasters of heights in, a .cuesta file out.

#include <cstdint>
#include <filesystem>
#include <vector>

#include "apps/cuesta/terrain_input.h"
#include "ooc/result.h"
#include "ooc/volume_options.h"

namespace cuesta::app {

enum class BuildType : std::uint8_t { automatic, surface, scene };

struct BuildSettings {
  std::vector<std::filesystem::path> inputs;  ///< at least one; several become one surface, in this order
  std::filesystem::path output;               ///< empty, for one input only: its name with .cuesta
  std::filesystem::path temp;                 ///< where the work folder goes; empty: beside the output
  std::uint64_t memory_bytes = 0;             ///< 0: three quarters of the machine's
  double step = 0;                            ///< grid step in world units (metres, of a terrain); 0 chooses
  double weld = 0;  ///< points on open borders this near to each other, in world units, become one; 0: none
  std::uint32_t cell_triangles = 1u << 15;
  BuildType type = BuildType::automatic;               ///< of terrains: automatic
  std::uint64_t largest_tom = std::uint64_t{1} << 17;  ///< of scenes: parts of more triangles are surfaces
  VolumeOptions volume;                                ///< of inputs that are volumes
  TerrainSettings terrain;                             ///< of inputs that are rasters of heights
  bool make_normals = true;                            ///< where the input has none
  bool incremental = false;  ///< keep what cells became, in <output>.cells, and use what is there
  bool force = false;        ///< build also when the output is up to date
  bool resume = true;        ///< go on with what an interrupted build left
  bool quiet = false;
};

/// Reads, cleans, builds, writes; prints a summary of one screen. Says "up to date" and does nothing more
/// when the output is there and would get the same bytes (build_fingerprint.h). What is interrupted, by a
/// signal, a crash or a full disk, stays in the work folder; the same call goes on from there.
/// @error of reading, cleaning and building; out_of_budget before the work that would need more memory or
/// disk; cancelled.
Result<void> run_build(const BuildSettings& settings);

}  // namespace cuesta::app
