#pragma once
/// Which key does what in the viewer: one table for the keys and for the help.

#include <cstdint>
#include <string>
#include <vector>

#include "runtime/draw/window.h"

namespace cuesta::view {

enum class Action : std::uint8_t {
  none,
  help,
  statistics,
  orbit,
  fly,
  walk,
  fit,
  tau_finer,
  tau_coarser,
  fewer_triangles,
  more_triangles,
  less_time,
  more_time,
  lit,
  wireframe,
  normals,
  changes,
  pages,
  relief,
  flatter,
  steeper,
  page_borders,
  policy,
  clip_play,
  clip_next,
  geomorph,
  freeze,
  screenshot,
  record,
  play,
  full_screen,
  leave,
  quit,
};

/// What a key that goes down means; none for those that move the camera, and others.
Action action_of(const WindowEvent& event);

/// Keys and what they do, as lines for the help.
std::vector<std::string> help_lines();

/// "f1", "[", "space", "home", "x": the name of a key as on the command line.
Key key_named(const std::string& name);

}  // namespace cuesta::view
