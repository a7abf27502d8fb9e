#pragma once
/// Meridians and parallels as borders of parts of a surface.

#include "ooc/grid.h"
#include "runtime/surface_part.h"
#include "terrain/terrain_metadata.h"

namespace cuesta::tiles {

enum class Side : std::uint8_t { west, south, east, north };

/// The border of all that is east of a meridian (west), north of a parallel (south), and so on, in grid
/// units. A meridian is a plane through the axis, so what is between two is within 180 degrees of both. A
/// parallel is the cone of all verticals there: it does not depend on height.
/// @pre frame.kind() is not projected
PartBorder globe_border(const Frame& frame, const Grid& grid, Side side, double degrees);

}  // namespace cuesta::tiles
