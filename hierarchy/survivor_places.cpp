#include "hierarchy/survivor_places.h"

#include <algorithm>

namespace cuesta {

std::optional<std::uint32_t> SurvivorPlaces::missing() const {
  const auto at = std::find(known_.begin(), known_.end(), std::uint8_t{0});
  if (at == known_.end()) return {};
  return static_cast<std::uint32_t>(at - known_.begin());
}

}  // namespace cuesta
