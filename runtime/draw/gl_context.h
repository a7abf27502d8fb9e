#pragma once
/// An OpenGL 3.3 core context, however it was obtained.

#include <cstdint>
#include <memory>
#include <string_view>

#include "ooc/result.h"

namespace cuesta {

using GlProc = void (*)();

/// Current when it is made. Its user makes it current again before each use, so that several may live in one
/// thread. The Renderer draws into its own framebuffer, so the size of the context's does not matter.
class GlContext {
 public:
  virtual ~GlContext() = default;
  /// Makes it the calling thread's context; cheap if it already is. False if the driver refuses.
  virtual bool make_current() = 0;
  /// Entry point by its full name ("glClear"); null if the driver does not have it.
  virtual GlProc proc(const char* name) const = 0;
  virtual std::string_view kind() const = 0;  ///< "osmesa", "egl", "glfw"
};

/// Off-screen context without any display or GPU (OSMesa, llvmpipe). The size is of its default framebuffer.
/// @error not_found without the library; io if Mesa gives no 3.3 core context.
Result<std::unique_ptr<GlContext>> make_osmesa_context(int width_px = 16, int height_px = 16);

/// Off-screen context by EGL, which needs no display: of the first GPU that gives one, else of a software
/// renderer (device platform, then Mesa's surfaceless platform, then the default display).
/// @error not_found without the library; io, saying what was tried, if nothing gives a 3.3 core context.
Result<std::unique_ptr<GlContext>> make_egl_context();

enum class OffscreenContext : std::uint8_t { automatic, egl, osmesa };

/// @param kind  automatic: EGL, and OSMesa where EGL gives none.
/// Threads: a thread that has used one kind must not use the other, for both may bring their own copy of
/// Mesa.
/// @error of the kind asked for; of both if none can be had.
Result<std::unique_ptr<GlContext>> make_offscreen_context(OffscreenContext kind);

}  // namespace cuesta
