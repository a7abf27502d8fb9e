#pragma once
/// Text over a picture: blocks of lines in the corners of a window, as rectangles for the GPU.

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "ooc/surface_mesh.h"

namespace cuesta {

enum class TextPlace : std::uint8_t { top_left, top_right, bottom_left, centre };

/// Lines of printable ASCII on a dark panel. A panel that is larger than the window loses its right and lower
/// parts.
struct TextBlock {
  TextPlace place = TextPlace::top_left;
  std::vector<std::string> lines;
};

/// A rectangle of one colour that shows those of its 5 × 8 parts whose bit is set (bitmap_font.h). 32 bytes.
struct TextQuad {
  float x, y, width, height;          ///< pixels from the top left
  std::uint32_t bits_low, bits_high;  ///< glyph_bits()
  Rgba8 colour;
  std::uint32_t unused = 0;
};
static_assert(sizeof(TextQuad) == 32);

/// Panels before the characters on them. Blanks give no rectangle.
/// @param scale  pixels per pixel of the font, ≥ 1.
std::vector<TextQuad> lay_out(std::span<const TextBlock> blocks, int scale, int width_px, int height_px);

}  // namespace cuesta
