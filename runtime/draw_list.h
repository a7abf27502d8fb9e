#pragma once
/// What the runtime hands to whoever draws: vertex and index pools, what changed in them, and what to draw.

#include <cstdint>
#include <span>

#include "ooc/grid.h"
#include "ooc/surface_mesh.h"

namespace cuesta {

/// One vertex as drawn: 20 bytes. Position in grid units (world = grid.origin + grid.step · position).
struct DrawVertex {
  std::int32_t x, y, z;
  std::int16_t normal_u, normal_v;  ///< octahedral, ±32767 is ±1; both -32768: no normal, shade flat
  Rgba8 colour;                     ///< sRGB
};
static_assert(sizeof(DrawVertex) == 20);

/// Half-open range [first, first + count) of elements.
struct Range {
  std::uint32_t first;
  std::uint32_t count;
};

/// A vertex in the middle of a geomorph.
struct MorphedVertex {
  std::uint32_t slot;
  DrawVertex vertex;
};

/// How a triangle came to be drawn in the last adapt(), for debug views.
enum class TriangleTag : std::uint8_t { unchanged = 0, coarse = 1, fine = 2 };

/// Spans stay valid until the next call that changes the owner.
struct DrawList {
  Grid grid;
  std::span<const DrawVertex> vertices;     ///< the whole pool; slots that nothing uses hold anything
  std::span<const TexCoord> texcoords;      ///< one per vertex slot, or empty
  std::span<const std::uint32_t> indices;   ///< the whole pool, three per triangle
  std::span<const Range> draws;             ///< ranges of `indices`, one per page with something to draw
  std::span<const Range> changed_vertices;  ///< ranges of `vertices` to upload since the last frame
  std::span<const Range> changed_indices;
  std::span<const MorphedVertex> morphed = {};  ///< drawn instead of what `vertices` holds, in this frame
  // For debug views; empty where the owner does not keep them.
  std::span<const std::uint32_t> draw_pages = {};    ///< page of each of `draws`
  std::span<const std::uint8_t> triangle_tags = {};  ///< a TriangleTag per triangle of `indices`
};

}  // namespace cuesta
