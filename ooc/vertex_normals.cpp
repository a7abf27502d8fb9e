#include "ooc/vertex_normals.h"

namespace cuesta {

std::vector<Vec3f> smooth_normals(std::span<const Vec3d> positions, std::span<const std::uint32_t> group,
                                  std::span<const Triangle> triangles) {
  std::vector<Vec3d> sums(positions.size());
  for (const Triangle& t : triangles) {
    const Vec3d a = positions[t[0]];
    const Vec3d twice_area = cross(positions[t[1]] - a, positions[t[2]] - a);
    for (const std::uint32_t v : t) sums[group[v]] = sums[group[v]] + twice_area;
  }
  std::vector<Vec3f> normals(positions.size());
  for (std::size_t v = 0; v < normals.size(); ++v)
    normals[v] = group[v] == v ? vec_cast<float>(normalized(sums[v])) : normals[group[v]];
  return normals;
}

}  // namespace cuesta
