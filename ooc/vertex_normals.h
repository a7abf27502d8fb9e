#pragma once
/// Smooth normals for a surface that has none.

#include <cstdint>
#include <span>
#include <vector>

#include "ooc/surface_mesh.h"
#include "ooc/triangle_order.h"

namespace cuesta {

/// Per vertex the unit mean of its group's triangles' normals, weighted by area; zero where they cancel.
/// @param positions  per vertex; far coordinates cost no accuracy: edges are taken first, in f64.
/// @param group      per vertex: the first vertex of its wedge group; groups are consecutive vertices.
/// @cost  O(vertices + triangles); 24 bytes per vertex beside the result. Sums in the order of the triangles.
std::vector<Vec3f> smooth_normals(std::span<const Vec3d> positions, std::span<const std::uint32_t> group,
                                  std::span<const Triangle> triangles);

}  // namespace cuesta
