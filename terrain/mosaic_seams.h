#pragma once
/// The surface of a mosaic of several lattices: which postings are covered by layers before, and the
/// triangles between what is left.
///
/// Layers are laid one after the other, by falling priority. Postings of a layer that lie inside of the
/// surface so far, or within cover_reach of it, are not used; between the rest and the surface so far remains
/// a gap. It is triangulated in the plane of the layer's columns and rows (around a pole, where the layer
/// goes around the Earth), with the outlines of both sides as segments, so that they share all their
/// vertices; triangles in the gap that are short are seams. Long ones are voids, or lie beyond the rim.
///
/// Memory: for outlines and runs of the parts of layers that are near others; their postings are read once,
/// row by row.

#include "terrain/mosaic_field.h"
#include "terrain/mosaic_parts.h"

namespace cuesta {

/// Edges across a gap are at most so long, in spacings of the layer, or in the longest edge of the outline
/// there if that is more. A used posting and the surface that it is next to are at most cover_reach + √2
/// = 2.12 apart.
inline constexpr double longest_seam = 2.25;
/// The same where the layer has data under the seam: between two surfaces there may be no room for any cell.
inline constexpr double longest_seam_over_data = 4;

/// Of a part of a layer.
struct LayerCover {
  LayerPart part = {};
  PostingRuns covered = PostingRuns();  ///< columns counted from the part's own
};

struct MosaicSeams {
  std::vector<LayerCover> covers;  ///< by rising layer
  std::vector<SeamTriangle> seams;
  std::uint64_t lost_segments =
      0;  ///< edges of outlines that others cross; there the surface may have a crack
};

/// @error of MosaicField::read().
Result<MosaicSeams> join_layers(const MosaicField& field);

}  // namespace cuesta
