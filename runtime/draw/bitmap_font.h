#pragma once
/// A font of 5 × 8 pixels for overlays: the 95 printable ASCII characters, 40 bits each, drawn as text in the
/// source.

#include <cstdint>

namespace cuesta {

inline constexpr int glyph_width = 5;   ///< one more column is left free between characters
inline constexpr int glyph_height = 8;  ///< the last row is for descenders

/// Bit y · glyph_width + x is pixel (x, y) from the top left. What is not printable ASCII is a box.
std::uint64_t glyph_bits(char c);

}  // namespace cuesta
