/// glTF 2.0 and GLB: every mesh of every scene's nodes, in world coordinates, once per node that shows it.
/// Meshes are visited in file order, each with all its nodes, so that compressed data is decoded once.

#include "ooc/gltf_chunks.h"
#include "ooc/gltf_data.h"
#include "ooc/gltf_document.h"
#include "ooc/gltf_primitive.h"
#include "ooc/gltf_transform.h"
#include "ooc/mesh_emitter.h"

namespace cuesta {
namespace gltf {
namespace {

constexpr std::array<float, 4> white{1, 1, 1, 1};

class Reader {
 public:
  Reader(const ReadJob& job, const Document& document, std::span<const char> binary)
      : job_(job), document_(document), data_(job, document, binary), out_(job, attributes(document)) {}

  Result<ReadReport> read() {
    auto report = read_meshes();
    // Errors too may come of a buffer that changed; only what the caller wanted does not.
    if (report || report.error().code != ErrorCode::cancelled) CUESTA_TRY(data_.check_unchanged());
    return report;
  }

 private:
  Result<ReadReport> read_meshes() {
    auto instances = instances_of(job_, document_, data_);
    if (!instances) return fail(std::move(instances).error());
    for (std::size_t mesh = 0; mesh < document_.meshes.size(); ++mesh) {
      const auto& placed = (*instances)[mesh];
      if (placed.empty()) continue;
      for (const Primitive& primitive : document_.meshes[mesh].primitives)
        if (is_surface(primitive)) CUESTA_TRY(emit(primitive, placed));
      out_.at_byte(job_.bytes.size() * (mesh + 1) / document_.meshes.size());
    }
    auto report = out_.finish();
    if (report) report->other_files = data_.other_files();
    return report;
  }

  static AttributeSet attributes(const Document& d) {
    AttributeSet set;
    for (const Mesh& mesh : d.meshes) {
      for (const Primitive& p : mesh.primitives) {
        set.normals |= p.normal != none;
        set.texcoords |= p.texcoord != none;
        set.colours |= p.colour != none;
        if (p.material != none) set.colours |= d.materials[p.material].base_colour != white;
      }
    }
    return set;
  }

  Result<void> emit(const Primitive& p, const std::vector<Affine>& placed) {
    const auto& colour = p.material == none ? white : document_.materials[p.material].base_colour;
    const auto emitted = emit_primitive(job_, document_, data_, p, colour, placed, first_vertex_, out_);
    if (!emitted) return fail(emitted.error());
    first_vertex_ = *emitted;
    return {};
  }

  const ReadJob& job_;
  const Document& document_;
  Data data_;
  MeshEmitter out_;
  std::uint64_t first_vertex_ = 0;
};

}  // namespace
}  // namespace gltf

Result<ReadReport> read_gltf(const ReadJob& job) {
  const auto parsed = gltf::parse_file(job);
  if (!parsed) return fail(parsed.error());
  return gltf::Reader(job, parsed->document, parsed->binary).read();
}

}  // namespace cuesta
