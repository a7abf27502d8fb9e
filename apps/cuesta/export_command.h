#pragma once
/// cuesta export: a cut of a .cuesta file as a mesh file, or all of it as tiles.

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>

#include "apps/cuesta/text_forms.h"

namespace cuesta::app {

/// By itself what the output's name says: .ply, .obj and .glb are meshes, .3tz is 3D Tiles.
enum class ExportFormat : std::uint8_t { by_name, ply, obj, glb, tiles_3d, quantized_mesh };

/// Exactly one of error, triangles, full and camera; triangles may also be a budget beside error or camera.
/// 3D Tiles have none of them; quantized-mesh may have an error, of its last level.
struct ExportSettings {
  std::filesystem::path file, output;
  ExportFormat format = ExportFormat::by_name;
  std::uint32_t tile_triangles = 65535;  ///< of 3D Tiles
  double border_share = 0.25;            ///< of 3D Tiles
  std::optional<double> error;           ///< world units
  std::optional<std::uint64_t> triangles;
  bool full = false;
  std::string node, part;  ///< of a scene, at most one: only nodes of this name, or the part of this name
  std::optional<CameraText> camera;
  double tau_px = 1;          ///< with a camera
  double outside_factor = 1;  ///< with a camera: how much coarser what is outside the picture may be
  View view;                  ///< with a camera: picture size and angle
  std::uint64_t cache_bytes = 0;
  bool json = false;  ///< tell it as JSON
  bool quiet = false;
};

/// What will be written; by_name where the name does not tell.
ExportFormat format_of(const ExportSettings& settings);

/// Prints the triangles and the guaranteed bound.
/// @error of reading; out_of_budget if the cut does not fit the cache; those of write_mesh; cancelled.
Result<void> run_export(const ExportSettings& settings);

}  // namespace cuesta::app
