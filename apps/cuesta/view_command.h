#pragma once
/// cuesta view: .cuesta files in a window.

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "apps/cuesta/text_forms.h"
#include "runtime/cut.h"
#include "runtime/draw/renderer.h"
#include "runtime/live_scene.h"

namespace cuesta::app {

struct ViewSettings {
  std::vector<std::filesystem::path> files;  ///< more can be dropped on the window
  View view;                                 ///< size of the window, angle, up
  bool up_given = false;                     ///< else a terrain's up is its own
  std::optional<CameraText> camera;
  double tau_px = 1;
  double visual_factor = 1;
  double outside_factor = 4;
  double geomorph_ms = 250;
  Budgets budgets{.adapt_ms = 4, .upload_bytes = 16ull << 20};
  std::uint64_t cache_bytes = 1ull << 30;  ///< of all files together
  std::uint32_t load_threads = 2;          ///< of each file; 0: frames wait for pages
  DrawOptions draw;
  std::optional<Shading> shading;              ///< none: relief for terrain, lit for the rest
  double exaggeration = 1;                     ///< of a terrain's heights
  PolicyKind policy = PolicyKind::predictive;  ///< of a scene
  double deadline_ms = 33;                     ///< of a scene's frame
  bool full_screen = false;
  std::filesystem::path flight;      ///< played at the start
  std::string press;                 ///< names of keys, pressed one a frame at the start
  std::filesystem::path screenshot;  ///< of the settled picture after the flight
  bool exit = false;                 ///< close after flight and screenshot
};

/// Shows surfaces, several in one world, or one scene.
/// Returns when the window is closed, or a stop is asked for; a recording in progress is saved then.
/// @error of reading the files; not_found or io where no window can be opened; of writing the screenshot.
Result<void> run_view(const ViewSettings& settings);

}  // namespace cuesta::app
