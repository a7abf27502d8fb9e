#include "ooc/triangle_order.h"

#include <algorithm>

namespace cuesta {
namespace {

template <class Key>
std::vector<std::uint32_t> counting_sort(std::vector<Triangle>& triangles, std::size_t keys, Key key_of) {
  std::vector<std::uint32_t> starts(keys + 1, 0);
  bool sorted = true;
  std::uint32_t previous = 0;
  for (const Triangle& t : triangles) {
    const std::uint32_t key = key_of(t);
    ++starts[key + std::size_t{1}];
    sorted = sorted && previous <= key;
    previous = key;
  }
  counts_to_starts(starts);
  if (sorted) return starts;
  std::vector<std::uint32_t> cursor(starts.begin(), starts.end() - 1);
  std::vector<Triangle> out(triangles.size());
  for (const Triangle& t : triangles) out[cursor[key_of(t)]++] = t;
  triangles = std::move(out);
  return starts;
}

}  // namespace

void counts_to_starts(std::span<std::uint32_t> counts) {
  std::uint32_t sum = 0;
  for (std::uint32_t& c : counts) c = sum += c;
}

std::vector<std::uint32_t> bucket_by_first(std::vector<Triangle>& triangles,
                                           std::span<const std::uint32_t> group) {
  return counting_sort(triangles, group.size(), [group](const Triangle& t) { return group[t[0]]; });
}

void sort_by_lowest_vertex(std::vector<Triangle>& triangles, std::size_t vertices) {
  for (Triangle& t : triangles) t = smallest_first(t);
  const auto starts = counting_sort(triangles, vertices, [](const Triangle& t) { return t[0]; });
  for (std::size_t v = 0; v < vertices; ++v)
    if (starts[v + 1] - starts[v] > 1)
      std::sort(triangles.begin() + starts[v], triangles.begin() + starts[v + 1]);
}

}  // namespace cuesta
