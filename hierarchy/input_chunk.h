#pragma once
/// A chunk of the clean input as the first round wants it.

#include "hierarchy/partition.h"
#include "hierarchy/round_chunk.h"
#include "ooc/input_surface.h"
#include "ooc/result.h"

namespace cuesta {

struct InputChunk {
  RoundChunk chunk;
  Partition cells;  ///< runs of its triangles
};

/// Reads chunk c and puts it in the order in which pages store it. Depends on nothing but the surface.
/// @error io, corrupt
Result<InputChunk> load_input_chunk(const InputSurface& surface, std::uint32_t c,
                                    std::uint32_t cell_triangles);

}  // namespace cuesta
