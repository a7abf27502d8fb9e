#include "runtime/draw/gl_program.h"

namespace cuesta {
namespace {

template <class GetLog>
std::string log_text(GLint length, GetLog get_log) {
  std::string text(static_cast<std::size_t>(length > 0 ? length : 0), '\0');
  GLsizei written = 0;
  if (!text.empty()) get_log(length, &written, text.data());
  text.resize(static_cast<std::size_t>(written));
  return text;
}

/// Compiles one stage and attaches it; the shader object then lives as long as the program.
Result<void> attach(const GlFunctions& gl, GLuint program, GLenum stage, const char* name,
                    const std::string& text) {
  if (text.empty()) return {};
  const GLuint shader = gl.CreateShader(stage);
  const GLchar* lines = text.c_str();
  gl.ShaderSource(shader, 1, &lines, nullptr);
  gl.CompileShader(shader);
  gl.AttachShader(program, shader);
  gl.DeleteShader(shader);
  GLint compiled = GL_FALSE, length = 0;
  gl.GetShaderiv(shader, GL_COMPILE_STATUS, &compiled);
  if (compiled == GL_TRUE) return {};
  gl.GetShaderiv(shader, GL_INFO_LOG_LENGTH, &length);
  const auto get_log = [&](GLsizei size, GLsizei* out, GLchar* to) {
    gl.GetShaderInfoLog(shader, size, out, to);
  };
  return fail(ErrorCode::io, "", std::string(name) + " shader",
              "the driver refuses it: " + log_text(length, get_log));
}

}  // namespace

Result<GlProgram> GlProgram::link(const GlFunctions& gl, const ShaderSources& sources) {
  GlProgram program(&gl, gl.CreateProgram());
  const GLuint id = program.id_;
  if (auto ok = attach(gl, id, GL_VERTEX_SHADER, "vertex", sources.vertex); !ok) return fail(ok.error());
  if (auto ok = attach(gl, id, GL_GEOMETRY_SHADER, "geometry", sources.geometry); !ok)
    return fail(ok.error());
  if (auto ok = attach(gl, id, GL_FRAGMENT_SHADER, "fragment", sources.fragment); !ok)
    return fail(ok.error());
  gl.LinkProgram(id);
  GLint linked = GL_FALSE, length = 0;
  gl.GetProgramiv(id, GL_LINK_STATUS, &linked);
  if (linked == GL_TRUE) return program;
  gl.GetProgramiv(id, GL_INFO_LOG_LENGTH, &length);
  const auto get_log = [&](GLsizei size, GLsizei* out, GLchar* to) {
    gl.GetProgramInfoLog(id, size, out, to);
  };
  return fail(ErrorCode::io, "", "program", "the driver refuses to link it: " + log_text(length, get_log));
}

}  // namespace cuesta
