#pragma once
/// The off-screen framebuffer that pictures are drawn into, multisampled or not.

#include "ooc/result.h"
#include "runtime/draw/gl_functions.h"
#include "runtime/draw/picture.h"

namespace cuesta {

/// sRGB colour and 32-bit float depth: 8 bytes per sample, and 4 per pixel of the resolved picture when
/// multisampled. The functions and the context must outlive it.
class FrameTarget {
 public:
  explicit FrameTarget(const GlFunctions& gl);
  FrameTarget(const FrameTarget&) = delete;
  FrameTarget& operator=(const FrameTarget&) = delete;
  ~FrameTarget() { release(); }

  /// Binds the framebuffer and its viewport, reallocating it if its size or sample count differs.
  /// @param samples_wanted  1 is none; the driver's limit applies.
  /// @error invalid_input above the driver's largest size; io if the driver refuses the framebuffer.
  Result<void> begin(int width_px, int height_px, int samples_wanted);
  /// Resolves the samples into the picture.
  void end();
  /// Holds the picture of the last `end()`: one sample per pixel. 0 before that.
  /// Of a pixel, in the picture that was begun last.
  int samples() const { return samples_ > 1 ? samples_ : 1; }
  GLuint picture() const { return samples_ > 1 ? resolved_.framebuffer : drawn_.framebuffer; }
  /// Into the context's own framebuffer, scaled to its size.
  void copy_to_window(int width_px, int height_px) const;
  int width_px() const { return width_px_; }
  int height_px() const { return height_px_; }
  /// The picture of the last `end()`; empty before that.
  Picture read() const;

 private:
  /// A framebuffer with a colour renderbuffer and, for drawing into, one for depth.
  struct Surface {
    GLuint framebuffer = 0, colour = 0, depth = 0;
  };
  bool allocate(Surface& surface, int samples, bool with_depth);
  void release(Surface& surface);
  void release();

  const GlFunctions& gl_;
  GLint max_samples_ = 1;
  GLint max_size_px_ = 0;
  int width_px_ = 0, height_px_ = 0, samples_ = 0;
  Surface drawn_;
  Surface resolved_;  ///< unused (zeros) when samples_ is 1
};

}  // namespace cuesta
