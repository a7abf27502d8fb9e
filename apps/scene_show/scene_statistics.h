#pragma once
/// What a viewer tells about a frame of a scene: TIME's figures 4 and 5 as numbers.

#include <optional>
#include <string>
#include <vector>

#include "apps/scene_show/scene_player.h"

namespace cuesta::scene_show {

struct ClipStatistics {
  std::string name;
  double time_s = 0, length_s = 0;
  bool playing = false;
};

struct SceneStatistics {
  std::string title;  ///< the file
  std::string driver;
  PolicyKind policy = PolicyKind::predictive;
  PlayedFrame frame;
  double frame_ms = 0;  ///< between frames, a running mean; 0: not known
  double tau_px = 0;
  std::string camera;                  ///< how it moves
  std::optional<ClipStatistics> clip;  ///< of scenes with clips
  std::string pointer;                 ///< the part under it; empty: none
  std::uint64_t cache_bytes = 0, unreadable_parts = 0;
  bool frozen = false;
};

std::vector<std::string> statistics_lines(const SceneStatistics& s);

}  // namespace cuesta::scene_show
