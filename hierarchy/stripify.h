#pragma once
/// Triangles as strips.

#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "ooc/triangle_order.h"

namespace cuesta {

/// Ends a strip in a list of indices: GL_PRIMITIVE_RESTART_FIXED_INDEX of 32-bit indices.
inline constexpr std::uint32_t strip_restart = 0xFFFFFFFFu;

/// Strips one after the other. Entries i, i + 1, i + 2 of a strip are a triangle, turned round where i is
/// odd.
struct StripSet {
  std::vector<std::uint32_t> entries;
  std::vector<std::uint32_t> begin;  ///< of each strip, and the end of the last

  std::uint32_t strip_count() const { return static_cast<std::uint32_t>(begin.size()) - 1; }
  std::span<const std::uint32_t> strip(std::uint32_t s) const {
    return std::span(entries).subspan(begin[s], begin[s + 1] - begin[s]);
  }
};

/// Whether a strip may go on across the edge between two vertices.
using MayCross = std::function<bool(std::uint32_t a, std::uint32_t b)>;

/// Strips with exactly the triangles given, each once and not turned over.
/// Source: Akeley, Haeberli, Burns, tomesh.c, SGI 1990: a strip begins where the fewest neighbours are left
/// and goes on to the one with the fewest; here in both directions, and an equal neighbour that needs no turn
/// first.
/// @pre no triangle has a vertex twice; vertices < vertex_count, at most 2^29 triangles.
/// @cost O(triangles · valence).
StripSet stripify(std::span<const Triangle> triangles, std::uint32_t vertex_count,
                  const MayCross& may_cross = {});

}  // namespace cuesta
