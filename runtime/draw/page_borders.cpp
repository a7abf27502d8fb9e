#include "runtime/draw/page_borders.h"

#include <string>

#include "runtime/draw/surface_shaders.h"

namespace cuesta {
namespace {

constexpr const char* whole_screen_text = R"(#version 330 core
void main() {
  gl_Position = vec4(gl_VertexID == 1 ? 3.0 : -1.0, gl_VertexID == 2 ? 3.0 : -1.0, 0.5, 1.0);
}
)";

constexpr const char* lines_text = R"(#version 330 core
uniform usampler2D numbers;
out vec4 pixel;

void main() {
  ivec2 at = ivec2(gl_FragCoord.xy);
  ivec2 most = textureSize(numbers, 0) - 1;
  uint here = texelFetch(numbers, at, 0).r;
  bool border = false;
  for (int i = 0; i < 4; ++i) {
    ivec2 step = ivec2(i == 0 ? 1 : i == 1 ? -1 : 0, i == 2 ? 1 : i == 3 ? -1 : 0);
    uint there = texelFetch(numbers, clamp(at + step, ivec2(0), most), 0).r;
    border = border || (here != 0u && there != 0u && here != there);
  }
  if (!border) discard;
  pixel = vec4(0.85, 0.04, 0.02, 0.8);
}
)";

}  // namespace

Result<void> PageBorders::compile(bool fragment_depth) {
  auto numbers = GlProgram::link(gl_, page_number_shaders(fragment_depth));
  if (!numbers) return fail(numbers.error());
  auto lines = GlProgram::link(gl_, {whole_screen_text, "", lines_text});
  if (!lines) return fail(lines.error());
  numbers_.emplace(std::move(*numbers));
  lines_.emplace(std::move(*lines));
  return {};
}

bool PageBorders::allocate() {
  gl_.GenVertexArrays(1, &vertex_array_);
  gl_.GenFramebuffers(1, &framebuffer_);
  gl_.BindFramebuffer(GL_FRAMEBUFFER, framebuffer_);
  gl_.GenTextures(1, &texture_);
  gl_.BindTexture(GL_TEXTURE_2D, texture_);
  gl_.TexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MIN_FILTER, GL_NEAREST);
  gl_.TexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MAG_FILTER, GL_NEAREST);
  gl_.TexImage2D(GL_TEXTURE_2D, 0, GL_R32UI, width_px_, height_px_, 0, GL_RED_INTEGER, GL_UNSIGNED_INT,
                 nullptr);
  gl_.FramebufferTexture2D(GL_FRAMEBUFFER, GL_COLOR_ATTACHMENT0, GL_TEXTURE_2D, texture_, 0);
  gl_.GenRenderbuffers(1, &depth_);
  gl_.BindRenderbuffer(GL_RENDERBUFFER, depth_);
  gl_.RenderbufferStorageMultisample(GL_RENDERBUFFER, 0, GL_DEPTH_COMPONENT32F, width_px_, height_px_);
  gl_.FramebufferRenderbuffer(GL_FRAMEBUFFER, GL_DEPTH_ATTACHMENT, GL_RENDERBUFFER, depth_);
  return gl_.CheckFramebufferStatus(GL_FRAMEBUFFER) == GL_FRAMEBUFFER_COMPLETE;
}

void PageBorders::release() {
  gl_.DeleteFramebuffers(1, &framebuffer_);
  gl_.DeleteTextures(1, &texture_);
  gl_.DeleteRenderbuffers(1, &depth_);
  gl_.DeleteVertexArrays(1, &vertex_array_);
  framebuffer_ = texture_ = depth_ = vertex_array_ = 0;
  width_px_ = height_px_ = 0;
}

Result<void> PageBorders::begin(int width_px, int height_px) {
  if (width_px != width_px_ || height_px != height_px_) {
    release();
    width_px_ = width_px;
    height_px_ = height_px;
    if (!allocate()) {
      release();
      return fail(ErrorCode::io, "", "", "the driver refuses a framebuffer for page borders");
    }
  }
  constexpr GLuint nothing[4] = {0, 0, 0, 0};
  constexpr GLfloat far = 0;  // reversed depth
  gl_.BindFramebuffer(GL_FRAMEBUFFER, framebuffer_);
  gl_.Viewport(0, 0, width_px_, height_px_);
  gl_.ClearBufferuiv(GL_COLOR, 0, nothing);
  gl_.ClearBufferfv(GL_DEPTH, 0, &far);
  return {};
}

void PageBorders::draw_onto(GLuint framebuffer) {
  gl_.BindFramebuffer(GL_FRAMEBUFFER, framebuffer);
  gl_.Viewport(0, 0, width_px_, height_px_);
  gl_.Disable(GL_DEPTH_TEST);
  gl_.Disable(GL_CULL_FACE);
  gl_.Enable(GL_BLEND);
  gl_.BlendFunc(GL_SRC_ALPHA, GL_ONE_MINUS_SRC_ALPHA);
  gl_.ActiveTexture(GL_TEXTURE0);
  gl_.BindTexture(GL_TEXTURE_2D, texture_);
  lines_->use();
  gl_.Uniform1i(lines_->uniform("numbers"), 0);
  gl_.BindVertexArray(vertex_array_);
  gl_.DrawArrays(GL_TRIANGLES, 0, 3);
  gl_.Disable(GL_BLEND);
}

}  // namespace cuesta
