#pragma once
/// A look at a part before it is read for good: how large it is, and whether it is equal to another one.

#include <cstdint>
#include <string>

#include "ooc/scene_source.h"

namespace cuesta {

struct PartFacts {
  ReadReport read;  ///< with the counts of vertices and triangles
  AttributeSet attributes;
  std::string content;  ///< the same for parts of the same vertices and triangles
};

/// Streams the part once. @error as SceneSource::read_part()
Result<PartFacts> survey_part(SceneSource& source, std::uint32_t part);

/// The part in memory. @error as SceneSource::read_part(); io: it is not what the survey saw
Result<SurfaceMesh> load_part(SceneSource& source, std::uint32_t part, const PartFacts& facts);

}  // namespace cuesta
