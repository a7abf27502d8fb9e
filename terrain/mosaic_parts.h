#pragma once
/// Where layers come near each other.

#include "terrain/mosaic_outline.h"

namespace cuesta {

/// Around what two layers share, in spacings of the coarser: enough for what is covered and the seam.
inline constexpr double part_margin = 8;

/// Parts of layers that others may touch, by rising layer; of each, a part for every group of files that lie
/// within `gap` postings of each other, so that the room between far files costs nothing. Judged by places in
/// steps of 1/32 of the groups' sides, and rather too large. The whole width where one reaches a pole.
/// @param gap  postings, at least 1: nearer files may have cells, or filled postings, between them.
std::vector<LayerPart> parts_near_others(const MosaicLayers& mosaic, std::uint64_t gap);

}  // namespace cuesta
