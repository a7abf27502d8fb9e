/// Bare Draco files (.drc): decoded whole, then emitted in blocks.

#include <algorithm>
#include <array>

#include "ooc/draco_mesh.h"
#include "ooc/mesh_emitter.h"

namespace cuesta {
namespace {

constexpr std::uint32_t slice = 1024;  ///< vertices converted at a time

class DracoFile {
 public:
  DracoFile(const ReadJob& job, const DracoMesh& mesh)
      : job_(job),
        mesh_(mesh),
        position_(mesh.find(DracoSemantic::position)),
        normal_(mesh.find(DracoSemantic::normal)),
        colour_(mesh.find(DracoSemantic::colour)),
        texcoord_(mesh.find(DracoSemantic::texcoord)),
        out_(job, {.normals = normal_ >= 0, .colours = colour_ >= 0, .texcoords = texcoord_ >= 0}) {}

  Result<ReadReport> emit() {
    if (position_ < 0) return job_.corrupt_at(0, "Draco data without positions");
    if (job_.expect) CUESTA_TRY(job_.expect(mesh_.vertices(), mesh_.triangles()));
    out_.at_byte(job_.bytes.size());
    for (std::uint32_t first = 0; first < mesh_.vertices();) {
      const std::uint32_t n = std::min(slice, mesh_.vertices() - first);
      CUESTA_TRY(emit_vertices(first, n));
      first += n;
    }
    CUESTA_TRY(out_.flush_vertices());
    out_.set_vertex_count(mesh_.vertices());
    for (std::uint32_t i = 0; i < mesh_.triangles(); ++i) {
      const auto [a, b, c] = mesh_.triangle(i);
      CUESTA_TRY(out_.triangle(a, b, c));
    }
    return out_.finish();
  }

 private:
  template <std::size_t N>
  void read(int attribute, std::uint32_t first, std::uint32_t n, std::array<double, N>& values,
            std::size_t stride) {
    mesh_.read(attribute, mesh_.is_normalised(attribute), first, n, stride, values.data());
  }

  Result<void> emit_vertices(std::uint32_t first, std::uint32_t n) {
    read(position_, first, n, positions_, 3);
    if (normal_ >= 0) read(normal_, first, n, normals_, 3);
    if (texcoord_ >= 0) read(texcoord_, first, n, texcoords_, 2);
    double colour_scale = 1;
    if (colour_ >= 0) {
      // Colours are 0…1 when real or marked as normalised, plain bytes otherwise (what draco_encoder writes).
      colour_scale = mesh_.is_real(colour_) || mesh_.is_normalised(colour_) ? 255 : 1;
      colours_.fill(255 / colour_scale);
      read(colour_, first, n, colours_, 4);
    }
    for (std::uint32_t i = 0; i < n; ++i) {
      Vertex v;
      v.position = {positions_[3 * i], positions_[3 * i + 1], positions_[3 * i + 2]};
      if (normal_ >= 0) {
        v.normal =
            normalized(vec_cast<float>(Vec3d{normals_[3 * i], normals_[3 * i + 1], normals_[3 * i + 2]}));
      }
      for (std::size_t k = 0; colour_ >= 0 && k < 4; ++k)
        v.colour[k] = colour_byte(colours_[4 * i + k] * colour_scale);
      if (texcoord_ >= 0)
        v.texcoord = {static_cast<float>(texcoords_[2 * i]), static_cast<float>(texcoords_[2 * i + 1])};
      CUESTA_TRY(out_.vertex(v));
    }
    return {};
  }

  const ReadJob& job_;
  const DracoMesh& mesh_;
  int position_, normal_, colour_, texcoord_;
  MeshEmitter out_;
  std::array<double, 3 * slice> positions_{};
  std::array<double, 3 * slice> normals_{};
  std::array<double, 4 * slice> colours_{};
  std::array<double, 2 * slice> texcoords_{};
};

}  // namespace

Result<ReadReport> read_draco(const ReadJob& job) {
  CUESTA_TRY(job.report_progress(0));
  const auto mesh = DracoMesh::decode(job.bytes, job.budget);
  if (!mesh) return fail(mesh.error());
  if (job.window) job.window->release_all();
  return DracoFile(job, *mesh).emit();
}

}  // namespace cuesta
