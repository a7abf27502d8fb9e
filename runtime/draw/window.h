#pragma once
/// A window with an OpenGL 3.3 core context, and what its user does as plain events.

#include <array>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "ooc/result.h"
#include "runtime/draw/gl_context.h"

namespace cuesta {

/// Keys that print are their upper-case ASCII character (of a US layout: the place counts).
enum class Key : std::uint16_t {
  unknown = 0,
  space = ' ',
  escape = 256,
  enter,
  tab,
  backspace,
  left,
  right,
  up,
  down,
  page_up,
  page_down,
  home,
  end,
  f1,
  f2,
  f3,
  f4,
  f5,
  f6,
  f7,
  f8,
  f9,
  f10,
  f11,
  f12,
  shift,
  control,
  alt,
};
constexpr Key key_of(char upper_case) {
  return static_cast<Key>(upper_case);
}

enum class MouseButton : std::uint8_t { left, right, middle };

struct WindowEvent {
  enum class Kind : std::uint8_t {
    key_down,  ///< also repeated, while the key is held
    key_up,
    button_down,
    button_up,
    move,    ///< the pointer is at x, y; dx, dy since the last move
    scroll,  ///< `notches` of the wheel, up is positive; the pointer is at x, y
    drop,    ///< files were dropped on the window
    redraw,  ///< the window's size changed, or what it showed was lost
    leave,   ///< the window lost the keyboard: no key is held any more
    close,   ///< the user wants it closed
  };
  Kind kind = Kind::redraw;
  Key key = Key::unknown;
  bool repeated = false;
  bool shift = false, control = false;
  MouseButton button = MouseButton::left;
  double x = 0, y = 0;  ///< pixels of the framebuffer, from the top left
  double dx = 0, dy = 0;
  double notches = 0;
  std::vector<std::filesystem::path> paths;
};

/// Threads: the main thread only. One at a time.
class Window {
 public:
  /// @error not_found without GLFW's library; io, with GLFW's reason, if there is no display, or none that
  /// gives a
  ///        3.3 core context.
  static Result<std::unique_ptr<Window>> open(const std::string& title, int width_px, int height_px);
  virtual ~Window() = default;

  /// For a Renderer. The window must outlive it.
  virtual std::unique_ptr<GlContext> context() = 0;
  /// What has happened since the last call, in order. Waits up to `wait_s` for something to happen.
  virtual std::vector<WindowEvent> events(double wait_s) = 0;
  /// Shows what was drawn into the context's framebuffer; waits for the screen where the driver does.
  virtual void show() = 0;
  /// Of the framebuffer; {0, 0} while the window is an icon.
  virtual std::array<int, 2> size_px() const = 0;
  /// How many pixels of the framebuffer make one of an ordinary screen.
  virtual double content_scale() const = 0;
  virtual void set_title(const std::string& title) = 0;
  virtual void set_full_screen(bool on) = 0;
  virtual bool full_screen() const = 0;
  /// Hides and holds the pointer, so that a drag has no end.
  virtual void hold_pointer(bool on) = 0;
};

}  // namespace cuesta
