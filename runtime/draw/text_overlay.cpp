#include "runtime/draw/text_overlay.h"

#include <algorithm>

#include "runtime/draw/bitmap_font.h"

namespace cuesta {
namespace {

constexpr int margin = 4;  // font pixels: around a panel, and between its edge and the text
constexpr int line_height = glyph_height + 2;
constexpr Rgba8 panel_colour{18, 22, 28, 190};
constexpr Rgba8 text_colour{235, 238, 242, 255};

TextQuad quad(int x, int y, int width, int height, std::uint64_t bits, Rgba8 colour) {
  return {static_cast<float>(x),
          static_cast<float>(y),
          static_cast<float>(width),
          static_cast<float>(height),
          static_cast<std::uint32_t>(bits),
          static_cast<std::uint32_t>(bits >> 32),
          colour};
}

void lay_out_block(const TextBlock& block, int scale, int width_px, int height_px,
                   std::vector<TextQuad>& quads) {
  std::size_t longest = 0;
  for (const std::string& line : block.lines) longest = std::max(longest, line.size());
  if (longest == 0) return;
  const int advance = glyph_width + 1;
  const int width = scale * (static_cast<int>(longest) * advance - 1 + 2 * margin);
  const int height = scale * (static_cast<int>(block.lines.size()) * line_height - 2 + 2 * margin);
  const int edge = scale * margin;
  int left = edge, top = edge;
  if (block.place == TextPlace::top_right) left = width_px - edge - width;
  if (block.place == TextPlace::bottom_left) top = height_px - edge - height;
  if (block.place == TextPlace::centre) {
    left = (width_px - width) / 2;
    top = (height_px - height) / 2;
  }
  left = std::max(left, 0);
  top = std::max(top, 0);
  quads.push_back(quad(left, top, width, height, ~std::uint64_t{0}, panel_colour));
  for (std::size_t row = 0; row < block.lines.size(); ++row)
    for (std::size_t i = 0; i < block.lines[row].size(); ++i) {
      const char c = block.lines[row][i];
      if (c == ' ') continue;
      quads.push_back(quad(left + edge + static_cast<int>(i) * advance * scale,
                           top + edge + static_cast<int>(row) * line_height * scale, glyph_width * scale,
                           glyph_height * scale, glyph_bits(c), text_colour));
    }
}

}  // namespace

std::vector<TextQuad> lay_out(std::span<const TextBlock> blocks, int scale, int width_px, int height_px) {
  std::vector<TextQuad> quads;
  for (const TextBlock& block : blocks) lay_out_block(block, scale, width_px, height_px, quads);
  return quads;
}

}  // namespace cuesta
