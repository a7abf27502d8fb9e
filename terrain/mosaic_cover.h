#pragma once
/// Which postings of a layer are not used, as layers before it cover their place.

#include "terrain/lattice_view.h"
#include "terrain/mosaic_outline.h"

namespace cuesta {

/// A posting within so many spacings of a surface before it is covered, too. Every point of a lattice
/// triangle is within √½ of a corner: so no triangle whose corners are all used meets that surface.
inline constexpr double cover_reach = 0.70712;

/// Postings of the part inside of the outline, or within cover_reach of it. Columns are counted from the
/// part's own.
/// @param view  of the part's layer, columns from the part's first, or around it.
PostingRuns covered_postings(std::span<const OutlineEdge> outline, const LatticeView& view,
                             const LayerPart& part);

}  // namespace cuesta
