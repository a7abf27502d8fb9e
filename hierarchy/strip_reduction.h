#pragma once
/// Strips written out, and repetitions in them: entries that can go without changing a triangle.
///   a b a b → a b: the windows between are degenerate, and the rest keeps its parity. (Also a a a a → a a.)
///   At the ends: while the last window, or the first two, are degenerate, they go.
/// So a strip whose substitutions all went along its sides, as the paper restricts them, has no other
/// repetition than the one that turns it (a b a).

#include <cstdint>
#include <cstring>
#include <span>

#include "hierarchy/stripify.h"

namespace cuesta {

/// Whether e[0], e[1] come again as e[2], e[3].
inline bool repeats(const std::uint32_t* e) {
  return e[0] == e[2] && e[1] == e[3];
}

/// How many entries can go at the front: all, where no triangle is left.
inline std::uint32_t spare_head(std::span<const std::uint32_t> strip) {
  std::size_t i = 0;
  while (i + 2 < strip.size() && is_degenerate(&strip[i])) ++i;
  if (i + 2 >= strip.size()) return static_cast<std::uint32_t>(strip.size());
  return static_cast<std::uint32_t>(i & ~std::size_t{1});
}

/// How many entries can go at the end of a strip that has a triangle.
inline std::uint32_t spare_tail(std::span<const std::uint32_t> strip) {
  std::uint32_t spare = 0;
  while (is_degenerate(strip.data() + strip.size() - 3 - spare)) ++spare;
  return spare;
}

/// Writes what is left of a strip, and strip_restart behind it; nothing of a strip without triangles.
/// @param to  has room for strip.size() + 1 elements.   @return how many were written.
inline std::size_t reduce_strip(std::span<const std::uint32_t> strip, std::uint32_t* to) {
  strip = strip.subspan(spare_head(strip));
  if (strip.empty()) return 0;
  strip = strip.first(strip.size() - spare_tail(strip));
  std::size_t length = 0;
  for (const std::uint32_t v : strip) {
    to[length++] = v;
    if (length >= 4 && repeats(to + length - 4)) length -= 2;
  }
  to[length++] = strip_restart;
  return length;
}

/// How many elements beyond the end copy_strip() may read and write.
inline constexpr std::size_t copy_slack = 8;

/// Writes a strip, and strip_restart behind it: in runs of eight, without a call for each strip.
/// @return as reduce_strip().
inline std::size_t copy_strip(const std::uint32_t* strip, std::size_t length, std::uint32_t* to) {
  for (std::size_t i = 0; i < length; i += copy_slack)
    std::memcpy(to + i, strip + i, copy_slack * sizeof *to);
  to[length] = strip_restart;
  return length + 1;
}

}  // namespace cuesta
