#pragma once
/// Stored samples to heights in metres.

#include <cstddef>
#include <span>

#include "terrain/height_raster.h"

namespace cuesta {

/// heights[i] = (sample[i] · scale + offset) · unit_m; NaN where the sample is no height, or the result is
/// infinite. No-data values are compared as the sample's type stores them: -3.4e38 of a file of f32 is its
/// nearest float.
/// @param samples  heights.size() of `type`, packed, in `order`.
void to_heights(std::span<const std::byte> samples, SampleType type, ByteOrder order,
                const SampleMeaning& meaning, std::span<double> heights);

/// Fills `samples` with the first no-data value that the type can store exactly, else with zeros: what a file
/// means by a block that it left out. Little-endian.
void fill_with_no_data(std::span<std::byte> samples, SampleType type, const SampleMeaning& meaning);

}  // namespace cuesta
