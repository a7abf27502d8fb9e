#include "hierarchy/page.h"

namespace cuesta {

std::vector<std::uint8_t> owned_vertices(const Page& page) {
  std::vector<std::uint8_t> owned(page.vertex_count, page.base ? 1 : 0);
  for (const Child& c : page.script.children) owned[c.vertex] = 1;
  for (std::uint32_t v : page.orphans) owned[v] = 1;
  return owned;
}

}  // namespace cuesta
