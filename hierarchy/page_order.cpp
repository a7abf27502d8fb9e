#include "hierarchy/page_order.h"

#include <meshoptimizer.h>
#include <tbb/enumerable_thread_specific.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <numeric>

#include "hierarchy/substitution_kernel.h"

namespace cuesta {
namespace {

/// A cell's triangles in strip order. @param number  per vertex of the chunk, all `none`; left so
void put_into_strips(std::span<Triangle> cell, std::vector<std::uint32_t>& number) {
  std::vector<std::uint32_t> vertices, local;
  local.reserve(cell.size() * 3);
  for (const Triangle& t : cell)
    for (std::uint32_t v : t) {
      if (number[v] == none) {
        number[v] = static_cast<std::uint32_t>(vertices.size());
        vertices.push_back(v);
      }
      local.push_back(number[v]);
    }
  for (std::uint32_t v : vertices) number[v] = none;
  std::vector<std::uint32_t> ordered(local.size());
  meshopt_optimizeVertexCacheStrip(ordered.data(), local.data(), local.size(), vertices.size());
  for (std::size_t i = 0; i < cell.size(); ++i)
    cell[i] = {vertices[ordered[i * 3]], vertices[ordered[i * 3 + 1]], vertices[ordered[i * 3 + 2]]};
}

/// First and last + 1 vertex of v's wedge group.
std::pair<std::uint32_t, std::uint32_t> group_of(const RoundChunk& chunk, std::uint32_t v) {
  const VertexId group = chunk.group_id(v);
  std::uint32_t first = v, last = v + 1;
  while (first > 0 && chunk.group_id(first - 1) == group) --first;
  while (last < chunk.ids.size() && chunk.group_id(last) == group) ++last;
  return {first, last};
}

/// Old number of each new vertex, in ascending order of new ids, which `chunk.ids` gets (in old order).
std::vector<std::uint32_t> number_by_first_use(RoundChunk& chunk) {
  std::vector<std::uint32_t> free;
  std::vector<std::uint8_t> known(chunk.locked);
  std::vector<VertexId> ids = chunk.ids;
  for (const Triangle& t : chunk.triangles)
    for (std::uint32_t v : t) {
      if (known[v]) continue;
      const auto [first, last] = group_of(chunk, v);
      for (std::uint32_t w = first; w < last; ++w) {
        known[w] = 1;
        ids[w] = chunk.first_free + free.size();
        free.push_back(w);
      }
    }
  chunk.ids = std::move(ids);
  // Locked vertices with lower ids, the free ones, locked vertices with higher ids.
  std::vector<std::uint32_t> order;
  order.reserve(chunk.ids.size());
  std::uint32_t v = 0;
  const auto add_locked = [&](auto wanted) {
    for (; v < chunk.ids.size(); ++v) {
      if (!chunk.locked[v]) continue;
      if (!wanted(chunk.ids[v])) break;
      order.push_back(v);
    }
  };
  add_locked([&](VertexId id) { return id < chunk.first_free; });
  order.insert(order.end(), free.begin(), free.end());
  add_locked([](VertexId) { return true; });
  return order;
}

void renumber(RoundChunk& chunk) {
  const auto order = number_by_first_use(chunk);
  std::vector<std::uint32_t> now(order.size());
  SurfaceChunk old;
  old.ids.swap(chunk.ids);
  old.wedge.swap(chunk.wedge);
  old.locked.swap(chunk.locked);
  std::swap(old.vertices, chunk.vertices);
  chunk.vertices = gather(old.vertices, order);
  for (std::uint32_t i = 0; i < order.size(); ++i) {
    now[order[i]] = i;
    chunk.ids.push_back(old.ids[order[i]]);
    chunk.wedge.push_back(old.wedge[order[i]]);
    chunk.locked.push_back(old.locked[order[i]]);
  }
  for (Triangle& t : chunk.triangles) t = {now[t[0]], now[t[1]], now[t[2]]};
}

}  // namespace

Partition order_for_pages(RoundChunk& chunk, std::uint32_t cell_triangles) {
  Partition cells =
      partition_cells(triangle_centres(chunk.triangles, chunk.vertices.positions), cell_triangles, 0);
  std::vector<Triangle> ordered;
  ordered.reserve(chunk.triangles.size());
  for (std::uint32_t t : cells.order) ordered.push_back(chunk.triangles[t]);
  chunk.triangles = std::move(ordered);
  std::iota(cells.order.begin(), cells.order.end(), 0u);
  tbb::enumerable_thread_specific<std::vector<std::uint32_t>> numbers(
      [&] { return std::vector<std::uint32_t>(chunk.ids.size(), none); });
  tbb::parallel_for(0u, cells.cell_count(), [&](std::uint32_t c) {
    const auto run = std::span(chunk.triangles).subspan(cells.begin[c], cells.begin[c + 1] - cells.begin[c]);
    put_into_strips(run, numbers.local());
  });
  renumber(chunk);
  return cells;
}

}  // namespace cuesta
