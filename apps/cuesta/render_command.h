#pragma once
/// cuesta render: pictures of a .cuesta file, one or a flight.

#include <cstdint>
#include <filesystem>
#include <optional>

#include "apps/cuesta/text_forms.h"
#include "apps/cuesta/video_file.h"
#include "runtime/cut.h"
#include "runtime/draw/renderer.h"
#include "runtime/flight.h"
#include "runtime/live_scene.h"

namespace cuesta::app {

struct RenderSettings {
  std::filesystem::path file;
  std::filesystem::path output;  ///< PNG for one picture, folder for a flight; empty: from the file's name
  std::optional<CameraText> camera;  ///< at most one of camera, orbit_frames and flight
  std::uint64_t orbit_frames = 0;
  std::filesystem::path flight;
  std::filesystem::path video;  ///< .mp4 or .webm of a flight; then PNGs only if there is an output, too
  View view;                    ///< picture size, angle, up
  bool up_given = false;        ///< else a terrain's up is its own
  double tau_px = 1;
  double visual_factor = 1;   ///< how much coarser what faces the eye may be
  double outside_factor = 4;  ///< how much coarser what is outside the picture may be
  Budgets budgets;            ///< adapt_ms and page_loads hold for all frames of a flight but the first
  std::uint64_t cache_bytes = 1ull << 30;
  std::uint32_t load_threads =
      0;                   ///< 0: frames wait for pages, so that a flight gives the same pictures each time
  double geomorph_ms = 0;  ///< of the flight's time, not the clock's
  bool settle = false;     ///< settle every frame of a flight
  bool stats_only = false;
  OffscreenContext context = OffscreenContext::automatic;
  DrawOptions draw;
  std::optional<Shading> shading;  ///< none: relief for terrain, lit for the rest
  double exaggeration = 1;         ///< of a terrain's heights
  // Of scenes, frame by frame of a flight; tau_px is then the finest that anything is drawn at.
  PolicyKind policy = PolicyKind::predictive;
  double deadline_ms = 33;  ///< of a whole frame
  bool quiet = false;
};

/// Where the frames of a flight go.
struct FrameFiles {
  std::filesystem::path folder;  ///< empty: no PNGs
  std::optional<VideoFile> video;

  Result<void> write(std::uint64_t frame, const Picture& picture);
};
/// Makes the folder and starts the video, as the settings say.
Result<FrameFiles> open_frame_files(const RenderSettings& settings, const Flight& flight);

/// One picture, or frame-00000.png …, frames.csv and frames.svg, or a video.
/// @error of reading the file or the flight; io of writing; cancelled. Where pages are damaged, the pictures
/// are
///        written, coarser there, and the first page's error is returned.
Result<void> run_render(const RenderSettings& settings);

}  // namespace cuesta::app
