#pragma once
/// Where a surface is open: the points of a chunk at edges with one triangle.

#include <cstdint>
#include <vector>

#include "ooc/space_tree.h"
#include "ooc/triangle_soup.h"

namespace cuesta {

/// A point on an open border, for one chunk that has a triangle there. 16 bytes.
struct BorderPoint {
  Vec3i position;
  std::uint32_t chunk = 0;
};

/// The points in `box` at which an edge has exactly one triangle, when triangles are joined at equal points
/// and degenerate and duplicate ones do not count; each once for every chunk that owns a triangle there,
/// whatever triangle. Attributes do not matter: a seam is no border.
/// @param soup  the chunk's triangles and the others' that have a corner in its box (consumed)
/// @cost  O(n log n) time, about 200 bytes per triangle.
std::vector<BorderPoint> border_points(TriangleSoup soup, const Box3<float>& box);

}  // namespace cuesta
