#define EGL_NO_X11
#define MESA_EGL_NO_X11_HEADERS
#include <EGL/egl.h>
#include <EGL/eglext.h>

#include <array>
#include <string>
#include <vector>

#include "runtime/draw/gl_context.h"
#include "runtime/draw/shared_library.h"

namespace cuesta {
namespace {

/// The library, loaded when the first context is made, as OSMesa is: it brings a driver, and need not be
/// there.
struct Egl {
  decltype(&eglGetProcAddress) proc = nullptr;
  decltype(&eglQueryString) query = nullptr;
  decltype(&eglGetDisplay) display = nullptr;
  decltype(&eglInitialize) initialize = nullptr;
  decltype(&eglBindAPI) bind_api = nullptr;
  decltype(&eglChooseConfig) choose = nullptr;
  decltype(&eglCreateContext) create = nullptr;
  decltype(&eglDestroyContext) destroy = nullptr;
  decltype(&eglCreatePbufferSurface) create_surface = nullptr;
  decltype(&eglDestroySurface) destroy_surface = nullptr;
  decltype(&eglMakeCurrent) make_current = nullptr;
  decltype(&eglGetCurrentContext) current = nullptr;
  // Extensions: null where the library lacks them.
  PFNEGLQUERYDEVICESEXTPROC query_devices = nullptr;
  PFNEGLQUERYDEVICESTRINGEXTPROC device_string = nullptr;
  PFNEGLGETPLATFORMDISPLAYEXTPROC platform_display = nullptr;
};

template <class F>
void find_extension(const Egl& egl, const char* name, F& function) {
  function = reinterpret_cast<F>(egl.proc(name));
}

/// Null if the system has no EGL. Stays loaded.
const Egl* egl_library() {
  static const Egl functions = [] {
    Egl f;
    void* const library = ::dlopen("libEGL.so.1", RTLD_NOW | RTLD_LOCAL);
    const bool found = library && find_function(library, "eglGetProcAddress", f.proc) &&
                       find_function(library, "eglQueryString", f.query) &&
                       find_function(library, "eglGetDisplay", f.display) &&
                       find_function(library, "eglInitialize", f.initialize) &&
                       find_function(library, "eglBindAPI", f.bind_api) &&
                       find_function(library, "eglChooseConfig", f.choose) &&
                       find_function(library, "eglCreateContext", f.create) &&
                       find_function(library, "eglDestroyContext", f.destroy) &&
                       find_function(library, "eglCreatePbufferSurface", f.create_surface) &&
                       find_function(library, "eglDestroySurface", f.destroy_surface) &&
                       find_function(library, "eglMakeCurrent", f.make_current) &&
                       find_function(library, "eglGetCurrentContext", f.current);
    if (!found) return Egl{};
    find_extension(f, "eglQueryDevicesEXT", f.query_devices);
    find_extension(f, "eglQueryDeviceStringEXT", f.device_string);
    find_extension(f, "eglGetPlatformDisplayEXT", f.platform_display);
    return f;
  }();
  return functions.current ? &functions : nullptr;
}

bool has_word(const char* words, std::string_view word) {
  if (!words) return false;
  const std::string all = std::string(" ") + words + " ";
  return all.find(" " + std::string(word) + " ") != std::string::npos;
}

class EglContext final : public GlContext {
 public:
  EglContext(const Egl& egl, EGLDisplay display, EGLContext context, EGLSurface surface)
      : egl_(egl), display_(display), context_(context), surface_(surface) {}
  EglContext(const EglContext&) = delete;
  EglContext& operator=(const EglContext&) = delete;
  ~EglContext() override {
    if (egl_.current() == context_)
      egl_.make_current(display_, EGL_NO_SURFACE, EGL_NO_SURFACE, EGL_NO_CONTEXT);
    egl_.destroy(display_, context_);
    if (surface_ != EGL_NO_SURFACE) egl_.destroy_surface(display_, surface_);
    // The display stays: others may use it, and it is the same one each time.
  }

  bool make_current() override {
    if (egl_.current() == context_) return true;
    return egl_.make_current(display_, surface_, surface_, context_) == EGL_TRUE;
  }
  GlProc proc(const char* name) const override { return egl_.proc(name); }
  std::string_view kind() const override { return "egl"; }

 private:
  const Egl& egl_;
  EGLDisplay display_;
  EGLContext context_;
  EGLSurface surface_;
};

/// A way to a display, not yet initialised.
struct Way {
  std::string name;
  EGLDisplay display;
};

void add_devices(const Egl& egl, bool software, std::vector<Way>& ways) {
  constexpr EGLint most_devices = 64;
  std::array<EGLDeviceEXT, most_devices> devices{};
  EGLint count = 0;
  if (!egl.query_devices || !egl.device_string || !egl.platform_display) return;
  if (egl.query_devices(most_devices, devices.data(), &count) != EGL_TRUE) return;
  for (EGLint i = 0; i < count; ++i) {
    const EGLDeviceEXT device = devices[static_cast<std::size_t>(i)];
    if (has_word(egl.device_string(device, EGL_EXTENSIONS), "EGL_MESA_device_software") != software) continue;
    ways.push_back({(software ? "software device " : "device ") + std::to_string(i),
                    egl.platform_display(EGL_PLATFORM_DEVICE_EXT, device, nullptr)});
  }
}

/// Hardware before software, what needs no display before what may.
std::vector<Way> ways_to_a_display(const Egl& egl) {
  std::vector<Way> ways;
  add_devices(egl, false, ways);
  if (egl.platform_display &&
      has_word(egl.query(EGL_NO_DISPLAY, EGL_EXTENSIONS), "EGL_MESA_platform_surfaceless"))
    ways.push_back({"surfaceless", egl.platform_display(EGL_PLATFORM_SURFACELESS_MESA, nullptr, nullptr)});
  add_devices(egl, true, ways);
  ways.push_back({"default display", egl.display(EGL_DEFAULT_DISPLAY)});
  return ways;
}

/// Null if this display has no 3.3 core context.
std::unique_ptr<GlContext> context_of(const Egl& egl, EGLDisplay display) {
  if (display == EGL_NO_DISPLAY || egl.initialize(display, nullptr, nullptr) != EGL_TRUE) return nullptr;
  if (egl.bind_api(EGL_OPENGL_API) != EGL_TRUE) return nullptr;
  const bool surfaceless = has_word(egl.query(display, EGL_EXTENSIONS), "EGL_KHR_surfaceless_context");
  const EGLint any_surface[] = {EGL_RENDERABLE_TYPE, EGL_OPENGL_BIT, EGL_SURFACE_TYPE, EGL_DONT_CARE,
                                EGL_NONE};
  const EGLint pbuffer[] = {EGL_RENDERABLE_TYPE, EGL_OPENGL_BIT, EGL_SURFACE_TYPE, EGL_PBUFFER_BIT, EGL_NONE};
  EGLConfig config = nullptr;
  EGLint count = 0;
  if (egl.choose(display, surfaceless ? any_surface : pbuffer, &config, 1, &count) != EGL_TRUE || count == 0)
    return nullptr;
  const EGLint version[] = {EGL_CONTEXT_MAJOR_VERSION,
                            3,
                            EGL_CONTEXT_MINOR_VERSION,
                            3,
                            EGL_CONTEXT_OPENGL_PROFILE_MASK,
                            EGL_CONTEXT_OPENGL_CORE_PROFILE_BIT,
                            EGL_NONE};
  const EGLContext handle = egl.create(display, config, EGL_NO_CONTEXT, version);
  if (handle == EGL_NO_CONTEXT) return nullptr;
  const EGLint size[] = {EGL_WIDTH, 16, EGL_HEIGHT, 16, EGL_NONE};
  const EGLSurface surface = surfaceless ? EGL_NO_SURFACE : egl.create_surface(display, config, size);
  auto context = std::make_unique<EglContext>(egl, display, handle, surface);
  if (!context->make_current()) return nullptr;
  return context;
}

}  // namespace

Result<std::unique_ptr<GlContext>> make_egl_context() {
  const Egl* const egl = egl_library();
  if (!egl)
    return fail(ErrorCode::not_found, "libEGL.so.1", "",
                "drawing on a GPU without a screen needs EGL; install it (Debian: libegl1)");
  std::string tried;
  for (const Way& way : ways_to_a_display(*egl)) {
    if (auto context = context_of(*egl, way.display)) return context;
    tried += (tried.empty() ? "" : ", ") + way.name;
  }
  return fail(ErrorCode::io, "", "", "EGL gives no OpenGL 3.3 core context (tried: " + tried + ")");
}

Result<std::unique_ptr<GlContext>> make_offscreen_context(OffscreenContext kind) {
  if (kind == OffscreenContext::osmesa) return make_osmesa_context();
  auto egl = make_egl_context();
  if (egl || kind == OffscreenContext::egl) return egl;
  auto osmesa = make_osmesa_context();
  if (osmesa) return osmesa;
  return fail(osmesa.error().code, "", "", egl.error().text() + "; " + osmesa.error().text());
}

}  // namespace cuesta
