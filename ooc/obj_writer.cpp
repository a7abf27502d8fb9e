#include <fmt/format.h>

#include <algorithm>
#include <iterator>

#include "ooc/mesh_formats_out.h"

namespace cuesta {

Result<void> write_obj(BufferedOutput& out, const SurfaceMesh& mesh) {
  const bool has_alpha =
      std::any_of(mesh.colours.begin(), mesh.colours.end(), [](const Rgba8& c) { return c[3] != 255; });
  fmt::memory_buffer line;
  const auto end_line = [&] {
    line.push_back('\n');
    out.put_bytes(line.data(), line.size());
    line.clear();
  };
  for (std::size_t i = 0; i < mesh.positions.size(); ++i) {
    const Vec3d& p = mesh.positions[i];
    fmt::format_to(std::back_inserter(line), "v {} {} {}", p.x, p.y, p.z);
    for (std::size_t k = 0; !mesh.colours.empty() && k < (has_alpha ? 4 : 3); ++k) {
      fmt::format_to(std::back_inserter(line), " {:.4g}", mesh.colours[i][k] / 255.0);
    }
    end_line();
  }
  for (const TexCoord& t : mesh.texcoords) {
    fmt::format_to(std::back_inserter(line), "vt {} {}", t[0], t[1]);
    end_line();
  }
  for (const Vec3f& n : mesh.normals) {
    fmt::format_to(std::back_inserter(line), "vn {} {} {}", n.x, n.y, n.z);
    end_line();
  }
  const char* corner = mesh.normals.empty() ? (mesh.texcoords.empty() ? " {0}" : " {0}/{0}")
                                            : (mesh.texcoords.empty() ? " {0}//{0}" : " {0}/{0}/{0}");
  for (const auto& t : mesh.triangles) {
    line.push_back('f');
    for (const std::uint32_t i : t)
      fmt::format_to(std::back_inserter(line), fmt::runtime(corner), std::uint64_t{i} + 1);
    end_line();
  }
  return {};
}

}  // namespace cuesta
