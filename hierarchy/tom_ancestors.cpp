#include "hierarchy/tom_ancestors.h"

#include <algorithm>

namespace cuesta {

void TomAncestors::fill(std::span<const std::uint32_t> substitute, std::uint32_t n, std::uint32_t end) {
  last_active_ = n - 1;
  down_.resize(end - last_active_);
  down_[0] = 0;
  // Substitutes precede: one pass upwards.
  const AncestorLookup ancestor = lookup();
  for (std::uint32_t v = n; v < end; ++v) down_[v - last_active_] = v - ancestor(substitute[v]);
}

void TomAncestors::look_up(std::span<const Triangle> from, Triangle* to) const {
  const AncestorLookup ancestor = lookup();
  for (const Triangle& t : from) *to++ = ancestor(t);
}

}  // namespace cuesta
