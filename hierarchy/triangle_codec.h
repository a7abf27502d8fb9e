#pragma once
/// A page's triangles as one step each: how a triangle hangs on those before it.
///
/// Triangles and vertices keep their numbers, which other pages refer to: so, unlike Edgebreaker, the order
/// of the walk is given, and what is coded is on which open edge the next triangle is put and which vertex it
/// adds.

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "hierarchy/number_planes.h"
#include "hierarchy/owned_mesh.h"

namespace cuesta {

/// Planes of packed triangles: steps, classes of vertex numbers, bits of vertex numbers.
inline constexpr std::size_t triangle_planes = 3;

/// @param hints  gets what each vertex can be guessed from: the triangle across the edge that it is first put
/// on
/// @pre each triangle has three different vertices below `vertex_count`. @cost O(triangles), 16 bytes per
/// vertex
std::vector<Plane> pack_triangles(std::span<const std::array<std::uint32_t, 3>> triangles,
                                  std::uint32_t vertex_count, std::vector<Hint>& hints);

/// Fills `triangles`, each smallest_first (triangle_order.h) with its winding kept.
/// @return false when the planes are damaged: what was accepted has three different vertices below
///         `vertex_count` in each triangle.
[[nodiscard]] bool unpack_triangles(std::span<const Plane> planes, std::uint32_t vertex_count,
                                    std::span<std::array<std::uint32_t, 3>> triangles,
                                    std::vector<Hint>& hints);

}  // namespace cuesta
