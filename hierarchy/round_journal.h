#pragma once
/// What the journal keeps of a finished chunk of a round, and what the next round knows of its pages.

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "hierarchy/cell_task.h"
#include "ooc/result.h"

namespace cuesta {

/// A finished cell: what its task gave, and where its survivors lie in the round's file.
struct CellRecord {
  CellFacts facts;
  std::uint64_t survivors_offset = 0, survivors_bytes = 0, survivors_checksum = 0;
};

struct ChunkRoundRecord {
  std::uint64_t container_end = 0, survivors_end = 0;  ///< of the two files, after this chunk
  std::vector<CellRecord> cells;
};

std::vector<std::byte> encode_record(const ChunkRoundRecord& record);
/// @error corrupt
Result<ChunkRoundRecord> decode_record(std::span<const std::byte> bytes);

}  // namespace cuesta
