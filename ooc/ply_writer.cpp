#include <fmt/format.h>

#include <algorithm>
#include <bit>

#include "ooc/mesh_formats_out.h"

namespace cuesta {
namespace {

static_assert(std::endian::native == std::endian::little, "values are written as they lie in memory");

bool fits_float(const SurfaceMesh& mesh) {
  return std::all_of(mesh.positions.begin(), mesh.positions.end(), [](const Vec3d& p) {
    const Vec3d rounded = vec_cast<double>(vec_cast<float>(p));
    const auto same = [](double a, double b) { return a == b || (a != a && b != b); };
    return same(rounded.x, p.x) && same(rounded.y, p.y) && same(rounded.z, p.z);
  });
}

}  // namespace

Result<void> write_ply(BufferedOutput& out, const SurfaceMesh& mesh) {
  const bool as_float = fits_float(mesh);
  const char* real = as_float ? "float" : "double";
  out.put(
      fmt::format("ply\nformat binary_little_endian 1.0\nelement vertex {}\n"
                  "property {} x\nproperty {} y\nproperty {} z\n",
                  mesh.positions.size(), real, real, real));
  if (!mesh.normals.empty()) out.put("property float nx\nproperty float ny\nproperty float nz\n");
  if (!mesh.colours.empty()) {
    out.put("property uchar red\nproperty uchar green\nproperty uchar blue\nproperty uchar alpha\n");
  }
  if (!mesh.texcoords.empty()) out.put("property float s\nproperty float t\n");
  out.put(fmt::format("element face {}\nproperty list uchar uint vertex_indices\nend_header\n",
                      mesh.triangles.size()));
  for (std::size_t i = 0; i < mesh.positions.size(); ++i) {
    if (as_float)
      out.put_value(vec_cast<float>(mesh.positions[i]));
    else
      out.put_value(mesh.positions[i]);
    if (!mesh.normals.empty()) out.put_value(mesh.normals[i]);
    if (!mesh.colours.empty()) out.put_value(mesh.colours[i]);
    if (!mesh.texcoords.empty()) out.put_value(mesh.texcoords[i]);
  }
  for (const auto& t : mesh.triangles) {
    out.put_value(std::uint8_t{3});
    out.put_value(t);
  }
  return {};
}

}  // namespace cuesta
