#pragma once
/// Draws the rectangles of a text overlay with OpenGL.

#include <optional>
#include <span>

#include "runtime/draw/gl_program.h"
#include "runtime/draw/text_overlay.h"

namespace cuesta {

/// Owns a buffer of the last overlay's size. The functions and the context must outlive it.
class TextPainter {
 public:
  explicit TextPainter(const GlFunctions& gl);
  TextPainter(const TextPainter&) = delete;
  TextPainter& operator=(const TextPainter&) = delete;
  ~TextPainter();

  /// @error io with the driver's message.
  Result<void> compile();
  /// Into the bound framebuffer, whose size is given. Colours are blended as they are stored (sRGB).
  void draw(std::span<const TextQuad> quads, int width_px, int height_px);

 private:
  const GlFunctions& gl_;
  std::optional<GlProgram> program_;
  GLuint vertex_array_ = 0, buffer_ = 0;
};

}  // namespace cuesta
