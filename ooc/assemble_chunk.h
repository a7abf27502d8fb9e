#pragma once
/// A clean chunk and what others tell it, put together: every vertex that its triangles use, by its number in
/// the whole surface.

#include <cstdint>
#include <span>

#include "ooc/clean_chunk.h"
#include "ooc/input_surface.h"
#include "ooc/result.h"

namespace cuesta {

/// @param replies  to chunk c, from all others.   @error corrupt when they do not fit the chunk
Result<SurfaceChunk> assemble_chunk(std::uint32_t c, CleanChunk chunk, std::span<const ChunkReplies> replies);

}  // namespace cuesta
