#pragma once
/// What each of a picture's drawing calls has filled, known afterwards.

#include <cstddef>
#include <span>
#include <vector>

#include "runtime/draw/gl_functions.h"
#include "runtime/part_fill.h"

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
  void end() const;
  /// One for each call of the picture, in their order. Pixels passed the depth test, those that later calls
  /// hid again included; fragments are those that the driver has shaded (Mesa: in blocks of 4 × 4, hidden or
  /// not), or, where it does not tell, as many as pixels.   @cost waits until the picture is finished
  std::span<const CallFill> read();

 private:
  struct Queries {
    GLuint pixels = 0, fragments = 0;
  };

  const GlFunctions& gl_;
  std::vector<Queries> queries_;
  std::size_t used_ = 0;
  float samples_ = 1;
  std::vector<CallFill> fill_;
};

}  // namespace cuesta
