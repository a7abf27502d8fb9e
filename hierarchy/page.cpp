#include "hierarchy/page.h"

namespace cuesta {

std::vector<std::uint8_t> owned_vertices(const Page& page) {
  std::vector<std::uint8_t> owned(page.vertex_count, page.base ? 1 : 0);
  for (const Child& c : page.script.children) owned[c.vertex] = 1;
  for (std::uint32_t v : page.orphans) owned[v] = 1;
  return owned;
}

std::vector<Vec3i> local_positions(const Page& page) {
  const auto owned = owned_vertices(page);
  std::vector<Vec3i> positions(page.vertex_count);
  auto from_owned = page.owned.positions.begin();
  auto from_coarser = page.survivors.begin();
  for (std::uint32_t v = 0; v < page.vertex_count; ++v)
    positions[v] = owned[v] ? *from_owned++ : *from_coarser++;
  return positions;
}

}  // namespace cuesta
