#pragma once
/// A compiled and linked OpenGL program.

#include <string>
#include <utility>

#include "ooc/result.h"
#include "runtime/draw/gl_functions.h"

namespace cuesta {

/// GLSL text of each stage. `geometry` may be empty.
struct ShaderSources {
  std::string vertex;
  std::string geometry;
  std::string fragment;
};

/// Owns one program object; the functions and the context must outlive it.
class GlProgram {
 public:
  /// @error io with the stage and the driver's message.
  static Result<GlProgram> link(const GlFunctions& gl, const ShaderSources& sources);
  GlProgram(GlProgram&& other) noexcept : gl_(other.gl_), id_(std::exchange(other.id_, 0)) {}
  GlProgram& operator=(GlProgram&& other) noexcept {
    std::swap(gl_, other.gl_);
    std::swap(id_, other.id_);
    return *this;
  }
  ~GlProgram() {
    if (id_) gl_->DeleteProgram(id_);
  }

  void use() const { gl_->UseProgram(id_); }
  /// -1, which OpenGL ignores, for a uniform that the program does not have or does not use.
  GLint uniform(const char* name) const { return gl_->GetUniformLocation(id_, name); }

 private:
  GlProgram(const GlFunctions* gl, GLuint id) : gl_(gl), id_(id) {}
  const GlFunctions* gl_;
  GLuint id_;
};

}  // namespace cuesta
