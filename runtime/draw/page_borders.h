#pragma once
/// Lines where pages meet, found in the picture: neighbouring pixels that show different pages.

#include <optional>

#include "runtime/draw/gl_program.h"

namespace cuesta {

/// Lines are as wide at any scale, and also run where a page hides another. 8 bytes per pixel while in use.
/// The functions and the context must outlive it.
class PageBorders {
 public:
  explicit PageBorders(const GlFunctions& gl) : gl_(gl) {}
  PageBorders(const PageBorders&) = delete;
  PageBorders& operator=(const PageBorders&) = delete;
  ~PageBorders() { release(); }

  /// @error io with the driver's message.
  Result<void> compile(bool fragment_depth);
  /// Clears and binds a target for page numbers. Draw all with numbers() then, with a reversed depth test.
  /// @error io if the driver refuses the target.
  Result<void> begin(int width_px, int height_px);
  const GlProgram& numbers() const { return *numbers_; }
  /// Draws the lines into a framebuffer of that size.
  void draw_onto(GLuint framebuffer);

 private:
  bool allocate();
  void release();

  const GlFunctions& gl_;
  std::optional<GlProgram> numbers_, lines_;
  int width_px_ = 0, height_px_ = 0;
  GLuint framebuffer_ = 0, texture_ = 0, depth_ = 0, vertex_array_ = 0;
};

}  // namespace cuesta
