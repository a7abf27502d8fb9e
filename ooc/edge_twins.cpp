#include "ooc/edge_twins.h"

#include <algorithm>
#include <utility>

namespace cuesta {
namespace {

/// An edge's higher group above, a half-edge along it below: half-edges of one edge are neighbours when
/// sorted.
using EdgeEntry = std::uint64_t;

std::uint32_t other_of(EdgeEntry e) {
  return static_cast<std::uint32_t>(e >> 32);
}
std::uint32_t half_edge_of(EdgeEntry e) {
  return static_cast<std::uint32_t>(e);
}

/// Calls f(lower group, entry) for the three half-edges of each triangle.
template <class F>
void for_each_edge(std::span<const Triangle> triangles, std::span<const std::uint32_t> group, F f) {
  std::uint32_t h = 0;
  for (const Triangle& t : triangles) {
    const Triangle g = {group[t[0]], group[t[1]], group[t[2]]};
    const auto edge = [&](std::uint32_t a, std::uint32_t b) {
      const auto [lo, hi] = std::minmax(a, b);
      f(lo, EdgeEntry{hi} << 32 | h++);
    };
    edge(g[0], g[1]);
    edge(g[1], g[2]);
    edge(g[2], g[0]);
  }
}

/// Most vertices are the lower end of half a dozen half-edges: too few for a call of std::sort to pay.
void sort_bucket(std::span<EdgeEntry> bucket) {
  if (bucket.size() > 16) {
    std::ranges::sort(bucket);
    return;
  }
  for (std::size_t i = 1; i < bucket.size(); ++i) {
    const EdgeEntry e = bucket[i];
    std::size_t j = i;
    for (; j > 0 && bucket[j - 1] > e; --j) bucket[j] = bucket[j - 1];
    bucket[j] = e;
  }
}

}  // namespace

std::vector<std::uint32_t> edge_twins(std::span<const Triangle> triangles,
                                      std::span<const std::uint32_t> group,
                                      std::span<const std::uint8_t> counted, std::uint64_t& edges_cut) {
  std::vector<std::uint32_t> ends(group.size() + 1, 0);
  for_each_edge(triangles, group, [&](std::uint32_t lo, EdgeEntry) { ++ends[lo + std::size_t{1}]; });
  counts_to_starts(ends);
  std::vector<EdgeEntry> entries(triangles.size() * 3);
  for_each_edge(triangles, group, [&](std::uint32_t lo, EdgeEntry e) { entries[ends[lo]++] = e; });

  std::vector<std::uint32_t> twins(triangles.size() * 3, kNone);
  const auto forward = [&](std::uint32_t h, std::size_t lo) { return group[start_of(triangles, h)] == lo; };
  std::size_t begin = 0;
  for (std::size_t lo = 0; lo < group.size(); ++lo) {  // the scatter moved each start to its bucket's end
    const std::size_t end = ends[lo];
    sort_bucket(std::span(entries).subspan(begin, end - begin));
    while (begin < end) {
      std::size_t stop = begin + 1;
      while (stop < end && other_of(entries[stop]) == other_of(entries[begin])) ++stop;
      const std::uint32_t a = half_edge_of(entries[begin]);
      const std::uint32_t b = half_edge_of(entries[stop - 1]);
      const std::size_t count = stop - begin;
      if (count == 2 && forward(a, lo) != forward(b, lo)) {
        twins[a] = b;
        twins[b] = a;
      } else if (count > 1) {
        edges_cut += counted[lo];
      }
      begin = stop;
    }
  }
  return twins;
}

}  // namespace cuesta
