#pragma once
/// What the viewer tells about a frame, as lines of an overlay.

#include <cstdint>
#include <string>
#include <vector>

#include "apps/view/camera_controls.h"
#include "runtime/cut.h"

namespace cuesta::view {

struct FrameStatistics {
  std::string title;  ///< files
  std::string driver;
  ControlMode mode = ControlMode::orbit;
  double speed = 0;  ///< world units per second
  double frame_ms = 0, draw_ms = 0;
  AdaptReport adapt;     ///< of all objects
  std::string bound_by;  ///< words for adapt.bound_by
  double tau_px = 1;
  Budgets budgets;
  std::uint64_t pages = 0, cache_bytes = 0;
  std::uint64_t upload_bytes = 0;
  std::uint32_t upload_calls = 0;
  std::uint64_t unreadable_pages = 0;
  bool frozen = false;
  std::vector<std::string> places;  ///< lines about where the camera and the pointer are, on terrain
};

std::vector<std::string> statistics_lines(const FrameStatistics& s);

}  // namespace cuesta::view
