#pragma once
/// Normals for meshes without: smooth along gentle edges, broken at sharp ones.

#include <span>

#include "ooc/surface_mesh.h"
#include "ooc/triangle_order.h"

namespace cuesta {

/// Faces that turn by more than 40° at an edge do not share normals there: a cylinder of 10 sides or more is
/// round, a cube keeps its edges.
inline constexpr double kCreaseCosine = 0.7660444431189780;

/// Gives every corner whose vertex has no normal (zero, or none in the mesh has one) the sum of the unit
/// normals of the faces that it is smooth with, weighted by their angles there. Vertices whose corners get
/// different normals are copied; copies come behind all others.
/// @param point  per vertex: a number that vertices at one position share, below their count
/// @cost O(n log n); 100 bytes per triangle meanwhile
void add_crease_normals(SurfaceMesh& mesh, std::span<const std::uint32_t> point);

}  // namespace cuesta
