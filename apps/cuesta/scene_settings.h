#pragma once
/// How render and view show a scene: what their settings have in common.

#include "apps/scene_show/scene_player.h"

namespace cuesta::app {

/// Of a deadline, what choosing resolutions may take: a tenth, as TIME has it.
inline constexpr double choice_share = 0.1;

template <class Settings>
scene_show::PlayerSettings player_settings(const Settings& s) {
  scene_show::PlayerSettings settings;
  settings.scene.policy = s.policy;
  settings.scene.cache_bytes = s.cache_bytes;
  settings.scene.load_threads = s.load_threads;
  settings.draw = s.draw;
  settings.draw.shading = s.shading.value_or(Shading::lit);
  settings.draw.surface_colour = {255, 255, 255, 255};  // materials have colours
  return settings;
}

}  // namespace cuesta::app
