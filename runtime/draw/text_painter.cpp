#include "runtime/draw/text_painter.h"

#include <cstddef>

#include "runtime/draw/bitmap_font.h"

namespace cuesta {
namespace {

constexpr GLuint box_attribute = 0, bits_attribute = 1, colour_attribute = 2;

constexpr const char* vertex_text = R"(#version 330 core
layout(location = 0) in vec4 box;  // left, top, width, height
layout(location = 1) in uvec2 glyph;
layout(location = 2) in vec4 glyph_colour;
uniform vec2 window_size;
out vec2 part;
flat out uvec2 bits;
flat out vec4 colour;

void main() {
  vec2 corner = vec2(gl_VertexID & 1, gl_VertexID >> 1);
  vec2 at = (box.xy + corner * box.zw) / window_size;
  gl_Position = vec4(2.0 * at.x - 1.0, 1.0 - 2.0 * at.y, 0.5, 1.0);
  part = corner * vec2(5.0, 8.0);
  bits = glyph;
  colour = glyph_colour;
}
)";
static_assert(glyph_width == 5 && glyph_height == 8, "as in the shader");

constexpr const char* fragment_text = R"(#version 330 core
in vec2 part;
flat in uvec2 bits;
flat in vec4 colour;
out vec4 pixel;

void main() {
  int bit = clamp(int(part.y), 0, 7) * 5 + clamp(int(part.x), 0, 4);
  uint word = bit < 32 ? bits.x : bits.y;
  if ((word >> uint(bit & 31) & 1u) == 0u) discard;
  pixel = colour;
}
)";

}  // namespace

TextPainter::TextPainter(const GlFunctions& gl) : gl_(gl) {
  const auto offset = [](std::size_t bytes) { return reinterpret_cast<const void*>(bytes); };
  constexpr GLsizei stride = sizeof(TextQuad);
  gl_.GenVertexArrays(1, &vertex_array_);
  gl_.BindVertexArray(vertex_array_);
  gl_.GenBuffers(1, &buffer_);
  gl_.BindBuffer(GL_ARRAY_BUFFER, buffer_);
  gl_.VertexAttribPointer(box_attribute, 4, GL_FLOAT, GL_FALSE, stride, offset(offsetof(TextQuad, x)));
  gl_.VertexAttribIPointer(bits_attribute, 2, GL_UNSIGNED_INT, stride, offset(offsetof(TextQuad, bits_low)));
  gl_.VertexAttribPointer(colour_attribute, 4, GL_UNSIGNED_BYTE, GL_TRUE, stride,
                          offset(offsetof(TextQuad, colour)));
  for (const GLuint attribute : {box_attribute, bits_attribute, colour_attribute}) {
    gl_.EnableVertexAttribArray(attribute);
    gl_.VertexAttribDivisor(attribute, 1);
  }
}

TextPainter::~TextPainter() {
  gl_.DeleteBuffers(1, &buffer_);
  gl_.DeleteVertexArrays(1, &vertex_array_);
}

Result<void> TextPainter::compile() {
  auto program = GlProgram::link(gl_, {vertex_text, "", fragment_text});
  if (!program) return fail(program.error());
  program_.emplace(std::move(*program));
  return {};
}

void TextPainter::draw(std::span<const TextQuad> quads, int width_px, int height_px) {
  if (quads.empty()) return;
  gl_.BindVertexArray(vertex_array_);
  gl_.BindBuffer(GL_ARRAY_BUFFER, buffer_);
  gl_.BufferData(GL_ARRAY_BUFFER, static_cast<GLsizeiptr>(quads.size_bytes()), quads.data(), GL_STREAM_DRAW);
  gl_.Disable(GL_FRAMEBUFFER_SRGB);
  gl_.Disable(GL_DEPTH_TEST);
  gl_.Disable(GL_CULL_FACE);
  gl_.Enable(GL_BLEND);
  gl_.BlendFunc(GL_SRC_ALPHA, GL_ONE_MINUS_SRC_ALPHA);
  program_->use();
  gl_.Uniform2f(program_->uniform("window_size"), static_cast<float>(width_px),
                static_cast<float>(height_px));
  gl_.DrawArraysInstanced(GL_TRIANGLE_STRIP, 0, 4, static_cast<GLsizei>(quads.size()));
  gl_.Disable(GL_BLEND);
}

}  // namespace cuesta
