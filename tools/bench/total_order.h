#pragma once
/// A total order of substitutions by quadric cost, for comparing structures that are built over one.

#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "ooc/surface_mesh.h"
#include "ooc/triangle_order.h"

namespace cuesta::bench {

/// Vertices 0 to r - 1 are active at resolution r; substitute[v] < v for v ≥ base.
struct TotalOrder {
  std::vector<Vec3d> positions;
  std::vector<Triangle> triangles;
  std::vector<std::uint32_t> substitute;
  std::uint32_t base = 0;
};

/// What else u → v must satisfy, in numbers of the mesh given; and what is told when it was applied.
struct Restriction {
  std::function<bool(std::uint32_t u, std::uint32_t v)> allows;
  /// @param around  the neighbours that u had, v among them; shared: those that were v's, too.
  std::function<void(std::uint32_t u, std::uint32_t v, std::span<const std::uint32_t> around,
                     std::span<const std::uint32_t> shared)>
      applied;
};

/// Substitutes along edges, the least quadric cost first (Garland, Heckbert 1997), until none is legal: the
/// link condition holds, u's triangles are one fan, borders stay borders, and no normal turns by more than
/// 84°.
/// @cost O(n log n), some 10 µs per triangle.
TotalOrder order_by_quadrics(const SurfaceMesh& mesh, const Restriction& restriction = {});

}  // namespace cuesta::bench
