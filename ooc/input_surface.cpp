#include "ooc/input_surface.h"

#include "ooc/check.h"

namespace cuesta {

Result<void> InputSurface::measure(std::span<const std::array<Vec3i, 3>>, std::span<float>) const {
  CUESTA_CHECK(!"only fields of heights can be measured");
  return {};
}

Result<std::vector<std::optional<std::vector<Vec3i>>>> InputSurface::postings_over(
    std::span<const std::array<Vec3i, 3>>, std::size_t) const {
  CUESTA_CHECK(!"only fields of heights have postings");
  return std::vector<std::optional<std::vector<Vec3i>>>{};
}

}  // namespace cuesta
