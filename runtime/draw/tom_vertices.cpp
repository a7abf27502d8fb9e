#include "runtime/draw/tom_vertices.h"

#include <cmath>

#include "ooc/oct_normal.h"

namespace cuesta {

DrawVertex vertex_of(const Tom& tom, std::size_t v) {
  const auto whole = [&](float x) { return static_cast<std::int32_t>(std::lround(double(x) / tom.step)); };
  const auto code = encode_oct(tom.normals.empty() ? Vec3f{} : tom.normals[v], 16);
  const Vec3f p = tom.positions[v];
  return {whole(p.x), whole(p.y), whole(p.z),
          code[0],    code[1],    tom.colours.empty() ? Rgba8{255, 255, 255, 255} : tom.colours[v]};
}

}  // namespace cuesta
