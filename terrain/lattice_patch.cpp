#include "terrain/lattice_patch.h"

#include <algorithm>

#include "ooc/check.h"

namespace cuesta {
namespace {
constexpr std::uint8_t no_fan = 0xFF;
}

LatticePatch::LatticePatch(std::uint32_t width, std::uint32_t height,
                           std::span<const std::uint8_t> has_height, PoleRows poles)
    : width_(width), height_(height), poles_(poles), has_height_(has_height) {
  CUESTA_CHECK(has_height.size() == (std::size_t{width} + 3) * (height + 3), has_height.size(), width,
               height);
  is_full_ = std::all_of(has_height.begin(), has_height.end(), [](std::uint8_t has) { return has != 0; });
}

std::array<std::uint8_t, 4> LatticePatch::fans_of_quarters(std::int64_t x, std::int64_t y,
                                                           std::uint32_t& count) const {
  const std::array<bool, 4> in{is_in(x, y - 1), is_in(x - 1, y - 1), is_in(x - 1, y), is_in(x, y)};
  // Between a quarter and the next lies this neighbour: north, west, south, east. A pole is all cells'.
  const std::array<bool, 4> edge{has(x, y - 1) || is_pole(y - 1), has(x - 1, y),
                                 has(x, y + 1) || is_pole(y + 1), has(x + 1, y)};
  std::array<std::uint8_t, 4> fan{no_fan, no_fan, no_fan, no_fan};
  count = 0;
  for (std::size_t q = 0; q < 4; ++q) {
    if (!in[q]) continue;
    const bool joins = q > 0 && in[q - 1] && edge[q - 1];
    fan[q] = joins ? fan[q - 1] : static_cast<std::uint8_t>(count++);
  }
  if (count > 1 && in[3] && in[0] && edge[3]) {  // the last fan goes on in the first
    const std::uint8_t last = fan[3];
    for (std::uint8_t& f : fan)
      if (f == last) f = 0;
    --count;
  }
  return fan;
}

std::uint32_t LatticePatch::fans(std::uint32_t x, std::uint32_t y) const {
  if (is_full_) return 1;
  if (!has(x, y)) return 0;
  std::uint32_t count = 0;
  fans_of_quarters(x, y, count);
  return count;
}

LatticePatch::Corner LatticePatch::corner(std::uint32_t x, std::uint32_t y, Quarter quarter) const {
  if (is_full_) return {x, y, 0};
  std::uint32_t count = 0;
  return {x, y, fans_of_quarters(x, y, count)[quarter]};
}

}  // namespace cuesta
