#pragma once
/// cuesta build: a mesh file in, a .cuesta file out.

#include <cstdint>
#include <filesystem>

#include "ooc/result.h"

namespace cuesta::app {

struct BuildSettings {
  std::filesystem::path input;
  std::filesystem::path output;  ///< empty: the input's name with .cuesta
  std::filesystem::path temp;    ///< folder for what compressed inputs unpack to; empty: TMPDIR, or else /tmp
  std::uint64_t memory_bytes = 0;  ///< 0: three quarters of the machine's
  double step = 0;                 ///< grid step in world units; 0 chooses
  std::uint32_t cell_triangles = 1u << 15;
  bool make_normals = true;  ///< where the input has none
  bool quiet = false;
};

/// Reads, cleans, builds, writes; prints a summary of one screen.
/// @error of reading, cleaning and building; out_of_budget before the work that would need more memory;
/// cancelled.
Result<void> run_build(const BuildSettings& settings);

}  // namespace cuesta::app
