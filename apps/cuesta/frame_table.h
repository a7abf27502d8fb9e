#pragma once
/// What a flight tells about each of its frames: as CSV and as a plot.

#include <filesystem>
#include <string>
#include <vector>

#include "runtime/cut.h"

namespace cuesta::app {

struct FrameRecord {
  double time_s = 0;
  AdaptReport adapt;
  double render_ms = 0;  ///< drawing and reading back; 0 if nothing was drawn
};

/// The budgets that the plot shows as lines.
struct FrameLimits {
  Budgets budgets;
  double tau_px = 1;
  std::uint64_t cache_bytes = 0;
};

/// Header and one row per frame: frame,time_s,triangles,adapt_ms,load_ms,render_ms,coarse_operations,
/// fine_operations,pages_loaded,sse_px,tau_px,resident_bytes,bound_by,settled,pages_missing,
/// upload_bytes,blocks_tested.
std::string frames_csv(const std::vector<FrameRecord>& frames);

/// Panels over time: triangles, adapt ms, sse px, resident MiB.  @error io.
Result<void> write_frames_plot(const std::filesystem::path& path, const std::string& title,
                               const std::vector<FrameRecord>& frames, const FrameLimits& limits);

/// Atomically.  @error io.
Result<void> write_text(const std::filesystem::path& path, const std::string& text);

}  // namespace cuesta::app
