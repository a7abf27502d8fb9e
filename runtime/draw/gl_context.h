#pragma once
/// A current OpenGL 3.3 core context and an off-screen target, however it was obtained.

#include <memory>
#include <string_view>

#include "ooc/result.h"

namespace cuesta {

using GlProc = void (*)();

/// Makes its context current on construction and keeps it so; one context per thread.
class GlContext {
 public:
  virtual ~GlContext() = default;
  virtual GlProc proc(const char* name) const = 0;
  virtual std::string_view kind() const = 0;  ///< "osmesa", "egl", "glfw"
};

/// Off-screen context without any display or GPU (OSMesa, llvmpipe). @error io if Mesa gives no 3.3 core context.
Result<std::unique_ptr<GlContext>> make_osmesa_context(int width_px, int height_px);

}  // namespace cuesta
