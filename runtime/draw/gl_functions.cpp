#include "runtime/draw/gl_functions.h"

#include <string>

namespace cuesta {
namespace {

template <class Function>
bool load(const GlContext& context, const char* name, Function& function) {
  function = reinterpret_cast<Function>(context.proc(name));
  return function != nullptr;
}

/// @param version  of OpenGL that has it: 45 is 4.5
bool has(const GlFunctions& gl, int version, std::string_view extension) {
  GLint major = 0, minor = 0, count = 0;
  gl.GetIntegerv(GL_MAJOR_VERSION, &major);
  gl.GetIntegerv(GL_MINOR_VERSION, &minor);
  if (major * 10 + minor >= version) return true;
  gl.GetIntegerv(GL_NUM_EXTENSIONS, &count);
  for (GLint i = 0; i < count; ++i) {
    const GLubyte* name = gl.GetStringi(GL_EXTENSIONS, static_cast<GLuint>(i));
    if (name && std::string_view(reinterpret_cast<const char*>(name)) == extension) return true;
  }
  return false;
}

std::string error_name(GLenum error) {
  switch (error) {
    case GL_INVALID_ENUM:
      return "invalid enum";
    case GL_INVALID_VALUE:
      return "invalid value";
    case GL_INVALID_OPERATION:
      return "invalid operation";
    case GL_INVALID_FRAMEBUFFER_OPERATION:
      return "invalid framebuffer operation";
    case GL_OUT_OF_MEMORY:
      return "out of memory";
    default:
      return "error " + std::to_string(error);
  }
}

}  // namespace

Result<GlFunctions> load_gl_functions(const GlContext& context) {
  GlFunctions gl;
#define CUESTA_GL_LOAD(type, name)         \
  if (!load(context, "gl" #name, gl.name)) \
    return fail(ErrorCode::io, "", "", "OpenGL 3.3 is needed, but the driver has no gl" #name);
  CUESTA_GL_FUNCTIONS(CUESTA_GL_LOAD)
#undef CUESTA_GL_LOAD
  if (has(gl, 45, "GL_ARB_clip_control")) load(context, "glClipControl", gl.ClipControl);
  gl.counts_fragments = has(gl, 46, "GL_ARB_pipeline_statistics_query");
  return gl;
}

Result<void> check_gl_errors(const GlFunctions& gl, const char* doing) {
  constexpr int max_flags = 8;  // a lost context may report errors for ever
  std::string names;
  bool out_of_memory = false;
  for (int i = 0; i < max_flags; ++i) {
    const GLenum error = gl.GetError();
    if (error == GL_NO_ERROR) break;
    out_of_memory = out_of_memory || error == GL_OUT_OF_MEMORY;
    names += (names.empty() ? "" : ", ") + error_name(error);
  }
  if (names.empty()) return {};
  return fail(out_of_memory ? ErrorCode::out_of_budget : ErrorCode::io, "", "",
              "OpenGL reports " + names + " while " + doing);
}

}  // namespace cuesta
