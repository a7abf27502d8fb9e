#include "hierarchy/scene_tom.h"

#include <string>

#include "hierarchy/tom_codec.h"
#include "ooc/check.h"

namespace cuesta {
namespace {

bool agrees(const Tom& tom, const ScenePartEntry& part, const TomSegment& segment) {
  const AttributeSet attributes{!tom.normals.empty(), !tom.colours.empty(), !tom.texcoords.empty()};
  return tom.full() == segment.vertices && tom.triangles.size() == segment.triangles &&
         attributes == part.attributes;
}

}  // namespace

Result<Tom> read_tom(const SceneFile& file, std::uint32_t part, std::uint32_t segments) {
  const ScenePartEntry& entry = file.parts()[part];
  CUESTA_CHECK(segments > 0 && segments <= entry.segments.size(), part, segments);
  Tom tom;
  for (std::uint32_t k = 0; k < segments; ++k) {
    const std::string place = "part " + std::to_string(part) + ", segment " + std::to_string(k);
    const auto bytes = file.read_segment(part, k);
    if (!bytes) return fail(bytes.error());
    if (auto r = decode_tom_segment(*bytes, tom); !r)
      return fail(r.error().code, file.path().string(), place, r.error().message);
    if (!agrees(tom, entry, entry.segments[k]))
      return fail(ErrorCode::corrupt, file.path().string(), place, "it contradicts the scene's directory");
  }
  return tom;
}

}  // namespace cuesta
