#pragma once
/// cuesta export: a cut of a .cuesta file as a mesh file.

#include <cstdint>
#include <filesystem>
#include <optional>

#include "apps/cuesta/text_forms.h"

namespace cuesta::app {

/// Exactly one of error, triangles, full and camera; triangles may also be a budget beside error or camera.
struct ExportSettings {
  std::filesystem::path file, output;
  std::optional<double> error;  ///< world units
  std::optional<std::uint64_t> triangles;
  bool full = false;
  std::optional<CameraText> camera;
  double tau_px = 1;          ///< with a camera
  double outside_factor = 1;  ///< with a camera: how much coarser what is outside the picture may be
  View view;                  ///< with a camera: picture size and angle
  std::uint64_t cache_bytes = 0;
  bool json = false;  ///< tell it as JSON
  bool quiet = false;
};

/// Prints the triangles and the guaranteed bound.
/// @error of reading; out_of_budget if the cut does not fit the cache; those of write_mesh; cancelled.
Result<void> run_export(const ExportSettings& settings);

}  // namespace cuesta::app
