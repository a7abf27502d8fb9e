#pragma once
/// Triangles as index triples: their corners, half-edges and order. Half-edge h = 3·triangle + corner runs
/// from its corner to the next one; 32 bits hold the half-edges of at most 2^32 / 3 triangles.

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace cuesta {

using Triangle = std::array<std::uint32_t, 3>;

/// No vertex, no half-edge.
inline constexpr std::uint32_t kNone = 0xffff'ffffu;
/// 32 bits hold the corners of this many triangles and a copy of each.
inline constexpr std::size_t kMaxTriangles = kNone / 6;

constexpr std::uint32_t next_half_edge(std::uint32_t h) {
  return h % 3 == 2 ? h - 2 : h + 1;
}
constexpr std::uint32_t prev_half_edge(std::uint32_t h) {
  return h % 3 == 0 ? h + 2 : h - 1;
}
/// The vertex that half-edge `h` starts from.
inline std::uint32_t start_of(std::span<const Triangle> triangles, std::uint32_t h) {
  return triangles[h / 3][h % 3];
}

/// Whether three corners, of a triangle or next to each other in a strip, are fewer vertices.
constexpr bool is_degenerate(const std::uint32_t* corners) {
  return corners[0] == corners[1] || corners[1] == corners[2] || corners[0] == corners[2];
}
constexpr bool is_degenerate(const Triangle& t) {
  return is_degenerate(t.data());
}

/// The same winding, smallest index first.
constexpr Triangle smallest_first(Triangle t) {
  if (t[1] < t[0] && t[1] < t[2]) return {t[1], t[2], t[0]};
  if (t[2] < t[0] && t[2] < t[1]) return {t[2], t[0], t[1]};
  return t;
}

/// Turns counts stored one place late (counts[i + 1] for bucket i, counts[0] = 0) into the start of each
/// bucket.
void counts_to_starts(std::span<std::uint32_t> counts);

/// Stable counting sort by group[t[0]].
/// @return `group.size() + 1` starts of buckets.   @pre triangles.size() ≤ kMaxTriangles.   @cost O(triangles
/// + groups)
std::vector<std::uint32_t> bucket_by_first(std::vector<Triangle>& triangles,
                                           std::span<const std::uint32_t> group);

/// Rotates each triangle's smallest index to the front and sorts by (t[0], t[1], t[2]).
/// @pre indices < `vertices`; triangles.size() ≤ kMaxTriangles.   @cost linear while few triangles start at
/// one vertex
void sort_by_lowest_vertex(std::vector<Triangle>& triangles, std::size_t vertices);

}  // namespace cuesta
