#include "hierarchy/strip_sides.h"

#include <algorithm>

#include "ooc/triangle_order.h"

namespace cuesta {

StripSides::StripSides(const StripSet& strips) {
  for (std::uint32_t s = 0; s < strips.strip_count(); ++s) {
    const auto strip = strips.strip(s);
    const std::uint32_t* before = nullptr;  // the triangle before
    for (std::size_t i = 0; i + 2 < strip.size(); ++i) {
      const std::uint32_t* now = &strip[i];
      if (is_degenerate(now)) continue;
      std::vector<std::uint32_t> both;
      if (before)
        for (int c = 0; c < 3; ++c)
          if (std::find(now, now + 3, before[c]) != now + 3) both.push_back(before[c]);
      if (both.size() == 2) crossed_.insert(key(both[0], both[1]));
      before = now;
    }
  }
}

void StripSides::applied(std::uint32_t u, std::uint32_t v, std::span<const std::uint32_t> around,
                         std::span<const std::uint32_t> shared) {
  for (const std::uint32_t w : around) {
    const bool crossed = crossed_.erase(key(u, w)) > 0;
    if (w == v) continue;
    const bool is_shared = std::find(shared.begin(), shared.end(), w) != shared.end();
    if (is_shared && !crossed) crossed_.erase(key(v, w));
    if (!is_shared && crossed) crossed_.insert(key(v, w));
  }
}

}  // namespace cuesta
