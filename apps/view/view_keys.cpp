#include "apps/view/view_keys.h"

#include <array>
#include <cctype>
#include <utility>

namespace cuesta::view {
namespace {

struct Binding {
  Action action;
  Key key, other;    ///< either
  const char* keys;  ///< as the help says it; null: with the line before
  const char* what;
};

constexpr std::array bindings{
    Binding{Action::help, Key::f1, key_of('H'), "F1 H", "this help"},
    Binding{Action::statistics, key_of('I'), Key::unknown, "I", "statistics"},
    Binding{Action::orbit, key_of('1'), Key::unknown, "1 2 3", "orbit, fly, walk"},
    Binding{Action::fly, key_of('2'), Key::unknown, nullptr, ""},
    Binding{Action::walk, key_of('3'), Key::unknown, nullptr, ""},
    Binding{Action::fit, key_of('F'), Key::home, "F Home", "show all"},
    Binding{Action::tau_finer, key_of('['), Key::unknown, "[ ]", "finer, coarser: tau"},
    Binding{Action::tau_coarser, key_of(']'), Key::unknown, nullptr, ""},
    Binding{Action::fewer_triangles, key_of(','), Key::unknown, ", .", "fewer, more triangles"},
    Binding{Action::more_triangles, key_of('.'), Key::unknown, nullptr, ""},
    Binding{Action::less_time, key_of(';'), Key::unknown, "; '", "less, more adapt time; scene: frame time"},
    Binding{Action::more_time, key_of('\''), Key::unknown, nullptr, ""},
    Binding{Action::lit, key_of('L'), Key::unknown, "L", "lit"},
    Binding{Action::wireframe, key_of('X'), Key::f2, "X F2", "wireframe"},
    Binding{Action::normals, key_of('N'), Key::f3, "N F3", "normals"},
    Binding{Action::changes, key_of('C'), Key::f4, "C F4", "changes: coarse path grey, fine path dark"},
    Binding{Action::pages, key_of('P'), Key::f5, "P F5", "pages in colours"},
    Binding{Action::relief, key_of('T'), Key::f7, "T F7", "terrain: colours of heights"},
    Binding{Action::flatter, key_of('-'), Key::unknown, "- =", "terrain: flatter, steeper"},
    Binding{Action::steeper, key_of('='), Key::unknown, nullptr, ""},
    Binding{Action::page_borders, key_of('B'), Key::f6, "B F6", "borders of pages"},
    Binding{Action::policy, key_of('V'), Key::unknown, "V", "scene: another policy of resolutions"},
    Binding{Action::clip_play, key_of('M'), Key::unknown, "M", "scene: play the clip; again: hold it"},
    Binding{Action::clip_next, key_of('O'), Key::unknown, "O", "scene: another clip"},
    Binding{Action::geomorph, key_of('G'), Key::unknown, "G", "blends between levels"},
    Binding{Action::freeze, key_of('Z'), Key::unknown, "Z", "freeze the triangles"},
    Binding{Action::screenshot, key_of('K'), Key::f12, "K F12", "save a picture"},
    Binding{Action::record, key_of('R'), Key::unknown, "R", "record a flight; again: save it"},
    Binding{Action::play, Key::space, Key::unknown, "Space", "play the flight; again: stop"},
    Binding{Action::full_screen, Key::f11, Key::unknown, "F11", "full screen"},
    Binding{Action::leave, Key::escape, Key::unknown, "Esc", "leave help, flight, full screen"},
};

constexpr std::pair<const char*, Key> named_keys[] = {
    {"space", Key::space},     {"escape", Key::escape},      {"enter", Key::enter},
    {"tab", Key::tab},         {"left", Key::left},          {"right", Key::right},
    {"up", Key::up},           {"down", Key::down},          {"home", Key::home},
    {"page-up", Key::page_up}, {"page-down", Key::page_down}};

}  // namespace

Action action_of(const WindowEvent& event) {
  if (event.kind != WindowEvent::Kind::key_down || event.key == Key::unknown) return Action::none;
  if (event.control)
    return event.key == key_of('Q') || event.key == key_of('W') ? Action::quit : Action::none;
  for (const Binding& b : bindings)
    if (event.key == b.key || event.key == b.other) return b.action;
  return Action::none;
}

std::vector<std::string> help_lines() {
  constexpr std::size_t column = 13;
  std::vector<std::string> lines;
  const auto add = [&](std::string keys, const char* what) {
    keys.resize(column, ' ');
    lines.push_back(keys + what);
  };
  lines.push_back("ORBIT");
  add("drag", "turn around");
  add("right drag", "sideways (also shift)");
  add("wheel", "nearer what is under the pointer");
  add("double click", "turn about what is there");
  add("Ctrl drag", "scene: move a part");
  lines.push_back("FLY, WALK");
  add("drag", "look around");
  add("W A S D", "move; arrows do, too");
  add("E Q", "up, down; walk: eye height");
  add("Shift Alt", "faster, slower");
  add("wheel", "speed");
  lines.push_back("");
  for (const Binding& b : bindings)
    if (b.keys) add(b.keys, b.what);
  add("Ctrl+Q", "close");
  lines.push_back("");
  lines.push_back("Drop .cuesta files here to see them, too.");
  return lines;
}

Key key_named(const std::string& name) {
  if (name.size() == 1) return key_of(static_cast<char>(std::toupper(static_cast<unsigned char>(name[0]))));
  for (const auto& [word, key] : named_keys)
    if (name == word) return key;
  if (name[0] == 'f' && name.size() <= 3)
    for (int n = 1; n <= 12; ++n)
      if (name == "f" + std::to_string(n)) return static_cast<Key>(static_cast<int>(Key::f1) + n - 1);
  return Key::unknown;
}

}  // namespace cuesta::view
