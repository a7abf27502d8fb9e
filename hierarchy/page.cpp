#include "hierarchy/page.h"

namespace cuesta {

std::vector<std::uint8_t> owned_vertices(const Page& page) {
  std::vector<std::uint8_t> owned(page.vertex_count, page.base ? 1 : 0);
  for (const Child& c : page.script.children) owned[c.vertex] = 1;
  for (std::uint32_t v : page.orphans) owned[v] = 1;
  return owned;
}

std::array<std::uint32_t, 3> rotated_lowest_first(std::array<std::uint32_t, 3> t) {
  if (t[1] < t[0] && t[1] <= t[2]) return {t[1], t[2], t[0]};
  if (t[2] < t[0] && t[2] < t[1]) return {t[2], t[0], t[1]};
  return t;
}

}  // namespace cuesta
