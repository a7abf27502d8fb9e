#pragma once
/// Where layers come near each other.

#include "terrain/mosaic_outline.h"

namespace cuesta {

/// Around what two layers share, in spacings of the coarser: enough for what is covered and the seam.
inline constexpr double part_margin = 8;

/// Of every layer the part that others may touch; width 0: there is none. Judged by places in steps of 1/32
/// of the layers' sides, and rather too large. The whole width where it reaches a pole.
std::vector<LayerPart> parts_near_others(std::span<const MosaicLayer> layers);

}  // namespace cuesta
