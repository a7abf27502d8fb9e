#include "ooc/surface_mesh.h"

namespace cuesta {

bool is_consistent(const SurfaceMesh& mesh) {
  const std::size_t n = mesh.positions.size();
  const auto fits = [n](const auto& attribute) { return attribute.empty() || attribute.size() == n; };
  if (!fits(mesh.normals) || !fits(mesh.colours) || !fits(mesh.texcoords)) return false;
  for (const auto& t : mesh.triangles)
    if (t[0] >= n || t[1] >= n || t[2] >= n) return false;
  return true;
}

}  // namespace cuesta
