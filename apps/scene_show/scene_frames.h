#pragma once
/// What a flight through a scene tells about each of its frames: figures 4 and 5 of TIME, as CSV and as a
/// plot.

#include <filesystem>
#include <span>
#include <string>

#include "apps/scene_show/scene_player.h"

namespace cuesta::scene_show {

/// Header and one row per frame:
/// frame,time_s,visible_objects,drawn_objects,visible_triangles,drawn_triangles,
/// changed_triangles,desired_ms,predicted_ms,optimisation_ms,choice_ms,actual_ms,outcome,resident_bytes,missing.
std::string scene_frames_csv(std::span<const PlayedFrame> frames);

/// Panels over time: triangles visible and drawn; times desired, predicted, of the optimisation, and actual.
/// @error io
Result<void> write_scene_plot(const std::filesystem::path& path, const std::string& title,
                              const std::string& subtitle, std::span<const PlayedFrame> frames);

struct DeadlineSummary {
  double within_share = 0;  ///< of frames that took no more than was desired
  double median_error = 0;  ///< of |actual / predicted - 1|
  double median_ms = 0, p99_ms = 0, most_ms = 0;
  double mean_use = 0;          ///< actual over desired
  double median_triangles = 0;  ///< drawn
};
DeadlineSummary summarise(std::span<const PlayedFrame> frames);

std::string_view name(ResolutionOutcome outcome);
std::string_view name(PolicyKind policy);

}  // namespace cuesta::scene_show
