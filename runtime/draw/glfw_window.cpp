#define GLFW_INCLUDE_NONE
#include <GLFW/glfw3.h>

#include <algorithm>
#include <utility>

#include "runtime/draw/shared_library.h"
#include "runtime/draw/window.h"

namespace cuesta {
namespace {

#define CUESTA_GLFW_FUNCTIONS(X) \
  X(CreateWindow)                \
  X(DestroyWindow)               \
  X(GetCurrentContext)           \
  X(GetFramebufferSize)          \
  X(GetPrimaryMonitor)           \
  X(GetProcAddress)              \
  X(GetVideoMode)                \
  X(GetWindowContentScale)       \
  X(GetWindowMonitor)            \
  X(GetWindowPos)                \
  X(GetWindowSize)               \
  X(GetWindowUserPointer)        \
  X(Init)                        \
  X(MakeContextCurrent)          \
  X(PollEvents)                  \
  X(SetCursorPosCallback)        \
  X(SetDropCallback)             \
  X(SetErrorCallback)            \
  X(SetFramebufferSizeCallback)  \
  X(SetInputMode)                \
  X(SetKeyCallback)              \
  X(SetMouseButtonCallback)      \
  X(SetScrollCallback)           \
  X(SetWindowCloseCallback)      \
  X(SetWindowFocusCallback)      \
  X(SetWindowMonitor)            \
  X(SetWindowRefreshCallback)    \
  X(SetWindowShouldClose)        \
  X(SetWindowTitle)              \
  X(SetWindowUserPointer)        \
  X(SwapBuffers)                 \
  X(SwapInterval)                \
  X(WaitEventsTimeout)           \
  X(WindowHint)

/// The library, loaded when the first window is opened: only a viewer needs the window system.
struct Glfw {
#define CUESTA_GLFW_MEMBER(name) decltype(&glfw##name) name = nullptr;
  CUESTA_GLFW_FUNCTIONS(CUESTA_GLFW_MEMBER)
#undef CUESTA_GLFW_MEMBER
};

/// Null if the system has no GLFW. Stays loaded, and initialised until the process ends.
const Glfw* glfw_library() {
  static const Glfw functions = [] {
    Glfw f;
    void* const library = ::dlopen("libglfw.so.3", RTLD_NOW | RTLD_LOCAL);
    bool found = library != nullptr;
#define CUESTA_GLFW_FIND(name) found = found && find_function(library, "glfw" #name, f.name);
    CUESTA_GLFW_FUNCTIONS(CUESTA_GLFW_FIND)
#undef CUESTA_GLFW_FIND
    return found ? f : Glfw{};
  }();
  return functions.WindowHint ? &functions : nullptr;
}

std::string& last_glfw_error() {
  static std::string text;
  return text;
}

void on_glfw_error(int, const char* text) {
  last_glfw_error() = text;
}

Key key_from(int glfw_key) {
  constexpr std::pair<int, Key> special[] = {{GLFW_KEY_ESCAPE, Key::escape},
                                             {GLFW_KEY_ENTER, Key::enter},
                                             {GLFW_KEY_KP_ENTER, Key::enter},
                                             {GLFW_KEY_TAB, Key::tab},
                                             {GLFW_KEY_BACKSPACE, Key::backspace},
                                             {GLFW_KEY_LEFT, Key::left},
                                             {GLFW_KEY_RIGHT, Key::right},
                                             {GLFW_KEY_UP, Key::up},
                                             {GLFW_KEY_DOWN, Key::down},
                                             {GLFW_KEY_PAGE_UP, Key::page_up},
                                             {GLFW_KEY_PAGE_DOWN, Key::page_down},
                                             {GLFW_KEY_HOME, Key::home},
                                             {GLFW_KEY_END, Key::end},
                                             {GLFW_KEY_LEFT_SHIFT, Key::shift},
                                             {GLFW_KEY_RIGHT_SHIFT, Key::shift},
                                             {GLFW_KEY_LEFT_CONTROL, Key::control},
                                             {GLFW_KEY_RIGHT_CONTROL, Key::control},
                                             {GLFW_KEY_LEFT_ALT, Key::alt},
                                             {GLFW_KEY_RIGHT_ALT, Key::alt}};
  for (const auto& [code, key] : special)
    if (code == glfw_key) return key;
  if (glfw_key >= GLFW_KEY_F1 && glfw_key <= GLFW_KEY_F12)
    return static_cast<Key>(static_cast<int>(Key::f1) + glfw_key - GLFW_KEY_F1);
  if (glfw_key >= ' ' && glfw_key < 127) return static_cast<Key>(glfw_key);
  return Key::unknown;
}

class GlfwContext final : public GlContext {
 public:
  GlfwContext(const Glfw& glfw, GLFWwindow* window) : glfw_(glfw), window_(window) {}
  bool make_current() override {
    if (glfw_.GetCurrentContext() != window_) glfw_.MakeContextCurrent(window_);
    return glfw_.GetCurrentContext() == window_;
  }
  GlProc proc(const char* name) const override { return glfw_.GetProcAddress(name); }
  std::string_view kind() const override { return "glfw"; }

 private:
  const Glfw& glfw_;
  GLFWwindow* window_;
};

class GlfwWindow final : public Window {
 public:
  GlfwWindow(const Glfw& glfw, GLFWwindow* window);
  GlfwWindow(const GlfwWindow&) = delete;
  GlfwWindow& operator=(const GlfwWindow&) = delete;
  ~GlfwWindow() override { glfw_.DestroyWindow(window_); }

  std::unique_ptr<GlContext> context() override { return std::make_unique<GlfwContext>(glfw_, window_); }
  std::vector<WindowEvent> events(double wait_s) override {
    wait_s > 0 ? glfw_.WaitEventsTimeout(wait_s) : glfw_.PollEvents();
    return std::exchange(events_, {});
  }
  void show() override { glfw_.SwapBuffers(window_); }
  std::array<int, 2> size_px() const override {
    std::array<int, 2> size{};
    glfw_.GetFramebufferSize(window_, &size[0], &size[1]);
    return size;
  }
  double content_scale() const override {
    float x = 1, y = 1;
    glfw_.GetWindowContentScale(window_, &x, &y);
    return static_cast<double>(std::max(x, y));
  }
  void set_title(const std::string& title) override { glfw_.SetWindowTitle(window_, title.c_str()); }
  void set_full_screen(bool on) override;
  bool full_screen() const override { return glfw_.GetWindowMonitor(window_) != nullptr; }
  void hold_pointer(bool on) override {
    glfw_.SetInputMode(window_, GLFW_CURSOR, on ? GLFW_CURSOR_DISABLED : GLFW_CURSOR_NORMAL);
    jumped_ = true;
  }

 private:
  static GlfwWindow& of(GLFWwindow* window) {
    return *static_cast<GlfwWindow*>(glfw_library()->GetWindowUserPointer(window));
  }
  WindowEvent& add(WindowEvent::Kind kind, int modifiers = 0);
  void listen();
  void moved_to(double x, double y);

  const Glfw& glfw_;
  GLFWwindow* window_;
  std::vector<WindowEvent> events_;
  double x_ = 0, y_ = 0;
  bool jumped_ = true;             ///< the next move is no motion of the mouse
  std::array<int, 4> windowed_{};  ///< place and size to come back to from full screen
};

GlfwWindow::GlfwWindow(const Glfw& glfw, GLFWwindow* window) : glfw_(glfw), window_(window) {
  glfw_.SetWindowUserPointer(window_, this);
  glfw_.MakeContextCurrent(window_);
  glfw_.SwapInterval(1);
  listen();
}

WindowEvent& GlfwWindow::add(WindowEvent::Kind kind, int modifiers) {
  WindowEvent& event = events_.emplace_back();
  event.kind = kind;
  event.shift = (modifiers & GLFW_MOD_SHIFT) != 0;
  event.control = (modifiers & GLFW_MOD_CONTROL) != 0;
  event.x = x_;
  event.y = y_;
  return event;
}

void GlfwWindow::moved_to(double x, double y) {
  std::array<int, 2> window{};
  glfw_.GetWindowSize(window_, &window[0], &window[1]);
  const auto pixels = size_px();
  if (window[0] > 0 && window[1] > 0) {
    x *= static_cast<double>(pixels[0]) / window[0];
    y *= static_cast<double>(pixels[1]) / window[1];
  }
  const double dx = jumped_ ? 0 : x - x_, dy = jumped_ ? 0 : y - y_;
  jumped_ = false;
  x_ = x;
  y_ = y;
  WindowEvent& event = add(WindowEvent::Kind::move);
  event.dx = dx;
  event.dy = dy;
}

void GlfwWindow::listen() {
  using Kind = WindowEvent::Kind;
  glfw_.SetKeyCallback(window_, [](GLFWwindow* w, int key, int, int action, int modifiers) {
    WindowEvent& event = of(w).add(action == GLFW_RELEASE ? Kind::key_up : Kind::key_down, modifiers);
    event.key = key_from(key);
    event.repeated = action == GLFW_REPEAT;
  });
  glfw_.SetMouseButtonCallback(window_, [](GLFWwindow* w, int button, int action, int modifiers) {
    if (button > GLFW_MOUSE_BUTTON_MIDDLE) return;
    WindowEvent& event = of(w).add(action == GLFW_RELEASE ? Kind::button_up : Kind::button_down, modifiers);
    event.button = static_cast<MouseButton>(button);
  });
  glfw_.SetCursorPosCallback(window_, [](GLFWwindow* w, double x, double y) { of(w).moved_to(x, y); });
  glfw_.SetScrollCallback(
      window_, [](GLFWwindow* w, double, double notches) { of(w).add(Kind::scroll).notches = notches; });
  glfw_.SetDropCallback(window_, [](GLFWwindow* w, int count, const char** paths) {
    of(w).add(Kind::drop).paths.assign(paths, paths + count);
  });
  glfw_.SetFramebufferSizeCallback(window_, [](GLFWwindow* w, int, int) { of(w).add(Kind::redraw); });
  glfw_.SetWindowRefreshCallback(window_, [](GLFWwindow* w) { of(w).add(Kind::redraw); });
  glfw_.SetWindowFocusCallback(window_, [](GLFWwindow* w, int focused) {
    if (focused == GLFW_FALSE) of(w).add(Kind::leave);
  });
  glfw_.SetWindowCloseCallback(window_, [](GLFWwindow* w) {
    glfw_library()->SetWindowShouldClose(w, GLFW_FALSE);  // whoever gets the event decides
    of(w).add(Kind::close);
  });
}

void GlfwWindow::set_full_screen(bool on) {
  if (on == full_screen()) return;
  jumped_ = true;
  if (!on) {
    glfw_.SetWindowMonitor(window_, nullptr, windowed_[0], windowed_[1], windowed_[2], windowed_[3], 0);
    return;
  }
  GLFWmonitor* const monitor = glfw_.GetPrimaryMonitor();
  const GLFWvidmode* const mode = monitor ? glfw_.GetVideoMode(monitor) : nullptr;
  if (!mode) return;
  glfw_.GetWindowPos(window_, &windowed_[0], &windowed_[1]);
  glfw_.GetWindowSize(window_, &windowed_[2], &windowed_[3]);
  glfw_.SetWindowMonitor(window_, monitor, 0, 0, mode->width, mode->height, mode->refreshRate);
}

}  // namespace

Result<std::unique_ptr<Window>> Window::open(const std::string& title, int width_px, int height_px) {
  const Glfw* const glfw = glfw_library();
  const char* const without = "; cuesta render draws pictures without a window";
  if (!glfw)
    return fail(ErrorCode::not_found, "libglfw.so.3", "",
                std::string("a window needs GLFW; install it (Debian: libglfw3)") + without);
  glfw->SetErrorCallback(on_glfw_error);
  if (glfw->Init() != GLFW_TRUE)
    return fail(ErrorCode::io, "", "", "no window can be opened: " + last_glfw_error() + without);
  glfw->WindowHint(GLFW_CONTEXT_VERSION_MAJOR, 3);
  glfw->WindowHint(GLFW_CONTEXT_VERSION_MINOR, 3);
  glfw->WindowHint(GLFW_OPENGL_PROFILE, GLFW_OPENGL_CORE_PROFILE);
  glfw->WindowHint(GLFW_OPENGL_FORWARD_COMPAT, GLFW_TRUE);
  glfw->WindowHint(GLFW_DEPTH_BITS, 0);  // pictures are drawn elsewhere, and copied
  glfw->WindowHint(GLFW_STENCIL_BITS, 0);
  GLFWwindow* const window = glfw->CreateWindow(width_px, height_px, title.c_str(), nullptr, nullptr);
  if (!window) return fail(ErrorCode::io, "", "", "no window can be opened: " + last_glfw_error() + without);
  return std::unique_ptr<Window>(std::make_unique<GlfwWindow>(*glfw, window));
}

}  // namespace cuesta
