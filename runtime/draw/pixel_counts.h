#pragma once
/// How many pixels each of a picture's drawing calls has written: what filling costs, known afterwards.

#include <cstddef>
#include <span>
#include <vector>

#include "runtime/draw/gl_functions.h"

namespace cuesta {

/// Owns GL's queries; its context must be current when it is used and when it goes.
class PixelCounts {
 public:
  explicit PixelCounts(const GlFunctions& gl) : gl_(gl) {}
  PixelCounts(const PixelCounts&) = delete;
  PixelCounts& operator=(const PixelCounts&) = delete;
  ~PixelCounts();

  /// Forgets the last picture's counts.   @param samples  of a pixel, >= 1
  void begin_picture(int samples);
  /// Around a call: the next of this picture.
  void begin();
  void end() const { gl_.EndQuery(GL_SAMPLES_PASSED); }
  /// One for each call of the picture, in their order: pixels that passed the depth test, those that later
  /// calls hid again included.   @cost waits until the picture is finished
  std::span<const float> read();

 private:
  const GlFunctions& gl_;
  std::vector<GLuint> queries_;
  std::size_t used_ = 0;
  float samples_ = 1;
  std::vector<float> pixels_;
};

}  // namespace cuesta
