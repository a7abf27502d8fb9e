#include "ooc/mesh_writer.h"

#include <cctype>

#include "ooc/check.h"
#include "ooc/mesh_formats_out.h"

namespace cuesta {

Result<void> write_mesh(const std::filesystem::path& path, const SurfaceMesh& mesh) {
  CUESTA_CHECK(is_consistent(mesh), path, mesh.positions.size(), mesh.triangles.size());
  std::string extension = path.extension().string();
  for (char& c : extension) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  const auto writer = extension == ".ply"   ? write_ply
                      : extension == ".obj" ? write_obj
                      : extension == ".glb" ? write_glb
                                            : nullptr;
  if (!writer) {
    return fail(ErrorCode::invalid_input, path.string(), "",
                "meshes are written as .ply, .obj or .glb, found \"" + extension + '"');
  }
  auto file = AtomicFile::create(path);
  if (!file) return fail(std::move(file).error());
  BufferedOutput out(*file);
  auto written = writer(out, mesh);
  if (written) written = out.flush();
  if (written) return file->commit();
  if (written.error().file.empty()) written.error().file = path.string();
  return written;
}

}  // namespace cuesta
