#include "runtime/draw/frame_target.h"

#include <algorithm>
#include <string>

#include "ooc/check.h"

namespace cuesta {

FrameTarget::FrameTarget(const GlFunctions& gl) : gl_(gl) {
  gl_.GetIntegerv(GL_MAX_SAMPLES, &max_samples_);
  gl_.GetIntegerv(GL_MAX_RENDERBUFFER_SIZE, &max_size_px_);
}

bool FrameTarget::allocate(Surface& surface, int samples, bool with_depth) {
  const GLsizei storage_samples = samples > 1 ? samples : 0;
  const auto attach = [&](GLuint& buffer, GLenum format, GLenum attachment) {
    gl_.GenRenderbuffers(1, &buffer);
    gl_.BindRenderbuffer(GL_RENDERBUFFER, buffer);
    gl_.RenderbufferStorageMultisample(GL_RENDERBUFFER, storage_samples, format, width_px_, height_px_);
    gl_.FramebufferRenderbuffer(GL_FRAMEBUFFER, attachment, GL_RENDERBUFFER, buffer);
  };
  gl_.GenFramebuffers(1, &surface.framebuffer);
  gl_.BindFramebuffer(GL_FRAMEBUFFER, surface.framebuffer);
  attach(surface.colour, GL_SRGB8_ALPHA8, GL_COLOR_ATTACHMENT0);
  if (with_depth) attach(surface.depth, GL_DEPTH_COMPONENT32F, GL_DEPTH_ATTACHMENT);
  return gl_.CheckFramebufferStatus(GL_FRAMEBUFFER) == GL_FRAMEBUFFER_COMPLETE;
}

void FrameTarget::release(Surface& surface) {
  gl_.DeleteFramebuffers(1, &surface.framebuffer);
  gl_.DeleteRenderbuffers(1, &surface.colour);
  gl_.DeleteRenderbuffers(1, &surface.depth);
  surface = {};
}

void FrameTarget::release() {
  release(drawn_);
  release(resolved_);
  samples_ = 0;
}

Result<void> FrameTarget::begin(int width_px, int height_px, int samples_wanted) {
  CUESTA_CHECK(width_px > 0 && height_px > 0, width_px, height_px);
  const std::string size = std::to_string(width_px) + " x " + std::to_string(height_px) + " pixels";
  if (std::max(width_px, height_px) > max_size_px_)
    return fail(ErrorCode::invalid_input, "", "",
                "a picture of " + size + " is asked for; the driver allows " + std::to_string(max_size_px_) +
                    " a side");
  const int samples = std::clamp(samples_wanted, 1, std::max(1, max_samples_));
  if (width_px != width_px_ || height_px != height_px_ || samples != samples_) {
    release();
    width_px_ = width_px;
    height_px_ = height_px;
    const bool complete = allocate(drawn_, samples, true) && (samples == 1 || allocate(resolved_, 1, false));
    if (!complete) return fail(ErrorCode::io, "", "", "the driver refuses a framebuffer of " + size);
    samples_ = samples;
  }
  gl_.BindFramebuffer(GL_FRAMEBUFFER, drawn_.framebuffer);
  gl_.Viewport(0, 0, width_px, height_px);
  return {};
}

void FrameTarget::end() {
  if (samples_ <= 1) return;
  gl_.BindFramebuffer(GL_READ_FRAMEBUFFER, drawn_.framebuffer);
  gl_.BindFramebuffer(GL_DRAW_FRAMEBUFFER, resolved_.framebuffer);
  gl_.BlitFramebuffer(0, 0, width_px_, height_px_, 0, 0, width_px_, height_px_, GL_COLOR_BUFFER_BIT,
                      GL_NEAREST);
}

void FrameTarget::copy_to_window(int width_px, int height_px) const {
  const bool same_size = width_px == width_px_ && height_px == height_px_;
  gl_.Disable(GL_FRAMEBUFFER_SRGB);  // the bytes as they are
  gl_.BindFramebuffer(GL_READ_FRAMEBUFFER, picture());
  gl_.BindFramebuffer(GL_DRAW_FRAMEBUFFER, 0);
  gl_.BlitFramebuffer(0, 0, width_px_, height_px_, 0, 0, width_px, height_px, GL_COLOR_BUFFER_BIT,
                      same_size ? GL_NEAREST : GL_LINEAR);
  gl_.BindFramebuffer(GL_FRAMEBUFFER, 0);
}

Picture FrameTarget::read() const {
  if (samples_ == 0) return {};
  Picture picture{width_px_, height_px_, {}};
  const std::size_t width = static_cast<std::size_t>(width_px_);
  picture.pixels.resize(width * static_cast<std::size_t>(height_px_));
  gl_.BindFramebuffer(GL_READ_FRAMEBUFFER, this->picture());
  gl_.ReadPixels(0, 0, width_px_, height_px_, GL_RGBA, GL_UNSIGNED_BYTE, picture.pixels.data());
  auto top = picture.pixels.begin();  // OpenGL's rows start at the bottom
  auto bottom = picture.pixels.end() - width_px_;
  for (; top < bottom; top += width_px_, bottom -= width_px_) std::swap_ranges(top, top + width_px_, bottom);
  return picture;
}

}  // namespace cuesta
