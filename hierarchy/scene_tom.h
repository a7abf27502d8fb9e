#pragma once
/// Parts of a scene's file as TOMs in memory.

#include "hierarchy/scene_file.h"
#include "hierarchy/tom.h"

namespace cuesta {

/// The TOM of the first `segments` segments, 1 to all of them. Concurrent calls are safe.
/// @pre part < file.parts().size(), it is a TOM and has so many segments
/// @error as SceneFile::read_segment(); corrupt: a segment is damaged, or contradicts the scene's directory;
/// place "part N, segment K"
Result<Tom> read_tom(const SceneFile& file, std::uint32_t part, std::uint32_t segments);

}  // namespace cuesta
