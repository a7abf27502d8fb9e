/// glTF 2.0 and GLB: every mesh of every scene's nodes, in world coordinates, once per node that shows it.
/// Meshes are visited in file order, each with all its nodes, so that compressed data is decoded once.
/// Vertex colour is COLOR_0 times the material's base colour, linear in the file, sRGB here; v is turned up.

#include <fmt/format.h>

#include <algorithm>
#include <cstring>

#include "ooc/draco_mesh.h"
#include "ooc/gltf_data.h"
#include "ooc/gltf_document.h"
#include "ooc/gltf_transform.h"
#include "ooc/mesh_emitter.h"
#include "ooc/srgb.h"

namespace cuesta {
namespace gltf {
namespace {

/// Vertices or triangles after which what they were read from is released: of 12 bytes, 768 KiB.
constexpr std::uint64_t release_elements = std::uint64_t{1} << 16;

struct Chunks {
  std::string_view json;
  std::span<const char> binary;
};

Result<Chunks> chunks_of(const ReadJob& job) {
  const std::span<const char> bytes = job.bytes;
  if (bytes.size() < 4 || std::memcmp(bytes.data(), "glTF", 4) != 0)
    return Chunks{{bytes.data(), bytes.size()}, {}};
  const auto word = [&](std::uint64_t at) {
    std::uint32_t value = 0;
    std::memcpy(&value, bytes.data() + at, 4);
    return value;
  };
  if (bytes.size() < 20) return job.corrupt_at(bytes.size(), "expected a GLB header and a JSON chunk");
  if (word(4) != 2) {
    return job.error(ErrorCode::unsupported_version, "byte 4",
                     fmt::format("GLB version {}; 2 can be read", word(4)));
  }
  const std::uint64_t length = word(8);
  if (length > bytes.size() || length < 20) {
    return job.corrupt_at(8, fmt::format("expected {} bytes, found {}", length, bytes.size()));
  }
  constexpr std::uint32_t json_type = 0x4e4f534a;
  constexpr std::uint32_t binary_type = 0x004e4942;
  const std::uint64_t json_bytes = word(12);
  if (word(16) != json_type || json_bytes > length - 20)
    return job.corrupt_at(12, "expected a JSON chunk that fits the file");
  Chunks chunks{{bytes.data() + 20, json_bytes}, {}};
  const std::uint64_t second = 20 + (json_bytes + 3) / 4 * 4;
  if (second + 8 > length || word(second + 4) != binary_type) return chunks;
  if (word(second) > length - second - 8)
    return job.corrupt_at(second, "expected a binary chunk that fits the file");
  chunks.binary = bytes.subspan(second + 8, word(second));
  return chunks;
}

/// The vertex streams of one primitive, from accessors or from Draco data.
struct Streams {
  std::uint64_t vertices = 0;
  std::optional<Numbers> position, normal, colour, texcoord, indices;
  std::optional<DracoMesh> draco;
  struct Source {
    int attribute = -1;
    bool normalised = false;
  };
  Source draco_normal, draco_colour, draco_texcoord, draco_position;
};

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
    auto instances = instances_of(job_, document_);
    if (!instances) return fail(std::move(instances).error());
    for (std::size_t mesh = 0; mesh < document_.meshes.size(); ++mesh) {
      const auto& placed = (*instances)[mesh];
      if (placed.empty()) continue;
      for (const Primitive& primitive : document_.meshes[mesh].primitives) {
        const bool drawn = primitive.mode != Mode::other && (primitive.position != none || primitive.draco);
        if (drawn) CUESTA_TRY(emit(primitive, placed));
      }
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
        if (p.material != none) set.colours |= d.base_colours[p.material] != std::array<float, 4>{1, 1, 1, 1};
      }
    }
    return set;
  }

  Result<void> emit(const Primitive& p, const std::vector<Transform>& placed) {
    data_.forget_decoded();
    auto streams = load(p);
    if (!streams) return fail(std::move(streams).error());
    base_colour_ = p.material == none ? std::array<float, 4>{1, 1, 1, 1} : document_.base_colours[p.material];
    for (const Transform& transform : placed) {
      CUESTA_TRY(emit_vertices(*streams, transform));
      CUESTA_TRY(emit_triangles(*streams, p.mode, transform.mirrored));
      first_vertex_ += streams->vertices;
    }
    return {};
  }

  Result<Streams> load(const Primitive& p) {
    Streams s;
    if (p.draco) {
      CUESTA_TRY(load_draco(p, s));
      return s;
    }
    CUESTA_TRY(load_numbers(p.position, 3, s.position));
    s.vertices = s.position->count;
    CUESTA_TRY(load_numbers(p.normal, 3, s.normal));
    CUESTA_TRY(load_numbers(p.colour, 3, s.colour));
    CUESTA_TRY(load_numbers(p.texcoord, 2, s.texcoord));
    for (const auto* other : {&s.normal, &s.colour, &s.texcoord}) {
      if (*other && (*other)->count < s.vertices) {
        return job_.error(
            ErrorCode::corrupt, "JSON",
            fmt::format("an attribute of {} elements beside {} positions", (*other)->count, s.vertices));
      }
    }
    CUESTA_TRY(load_numbers(p.indices, 1, s.indices));
    return s;
  }
  Result<void> load_numbers(Id accessor, std::uint32_t least_components, std::optional<Numbers>& out) {
    if (accessor == none) return {};
    auto numbers = data_.numbers(accessor);
    if (!numbers) return fail(std::move(numbers).error());
    if (numbers->components < least_components) {
      return job_.error(
          ErrorCode::corrupt, fmt::format("accessor {}", accessor),
          fmt::format("expected {} components, found {}", least_components, numbers->components));
    }
    out = *numbers;
    return {};
  }

  Result<void> load_draco(const Primitive& p, Streams& s) {
    auto bytes = data_.view(p.draco->view);
    if (!bytes) return fail(std::move(bytes).error());
    auto mesh = DracoMesh::decode(*bytes, job_.budget);
    data_.release(bytes->data(), bytes->data() + bytes->size());
    if (!mesh) return fail(std::move(mesh).error());
    const auto source = [&](std::uint32_t unique_id, Id accessor) {
      Streams::Source found;
      if (unique_id == none || accessor == none) return found;
      found.attribute = mesh->find_id(unique_id);
      found.normalised = document_.accessors[accessor].normalised;
      return found;
    };
    s.draco_position = source(p.draco->position, p.position);
    s.draco_normal = source(p.draco->normal, p.normal);
    s.draco_colour = source(p.draco->colour, p.colour);
    s.draco_texcoord = source(p.draco->texcoord, p.texcoord);
    if (s.draco_position.attribute < 0)
      return job_.error(ErrorCode::corrupt, "JSON", "Draco data without positions");
    s.vertices = mesh->vertices();
    s.draco = std::move(*mesh);
    return {};
  }

  /// Up to N components of one vertex; those that are not in the file keep what `values` holds.
  template <std::size_t N>
  static bool fetch(const Streams& s, const std::optional<Numbers>& numbers, Streams::Source draco,
                    std::uint64_t i, std::array<double, N>& values) {
    if (s.draco && draco.attribute >= 0) {
      s.draco->read(draco.attribute, draco.normalised, static_cast<std::uint32_t>(i), 1, N, values.data());
      return true;
    }
    if (!numbers) return false;
    const std::uint32_t n = std::min<std::uint32_t>(N, numbers->components);
    for (std::uint32_t k = 0; k < n; ++k) values[k] = numbers->real(i, k);
    return true;
  }

  Rgba8 stored_colour(const std::array<double, 4>& vertex_colour) const {
    Rgba8 colour{};
    for (std::size_t k = 0; k < 4; ++k) {
      const double linear = std::clamp(vertex_colour[k] * static_cast<double>(base_colour_[k]), 0.0, 1.0);
      colour[k] = colour_byte(255 * (k == 3 ? linear : srgb_from_linear(linear)));
    }
    return colour;
  }

  /// Elements from `first` to `last` have been read.
  void passed(const std::optional<Numbers>& numbers, std::uint64_t first, std::uint64_t last) const {
    if (!numbers || numbers->count == 0) return;
    last = std::min(last, numbers->count - 1);  // behind the last there need not be a whole stride
    data_.release(numbers->first + first * numbers->stride, numbers->first + last * numbers->stride);
  }

  void passed_vertices(const Streams& s, std::uint64_t first, std::uint64_t last) const {
    for (const auto* stream : {&s.position, &s.normal, &s.colour, &s.texcoord}) passed(*stream, first, last);
  }

  Result<void> emit_vertices(const Streams& s, const Transform& transform) {
    const Rgba8 plain_colour = stored_colour({1, 1, 1, 1});
    for (std::uint64_t i = 0; i < s.vertices; ++i) {
      if (i % release_elements == 0 && i > 0) passed_vertices(s, i - release_elements, i);
      Vertex v;
      std::array<double, 3> p{}, n{};
      std::array<double, 4> c{1, 1, 1, 1};
      std::array<double, 2> t{};
      fetch(s, s.position, s.draco_position, i, p);
      v.position = transform.point({p[0], p[1], p[2]});
      if (fetch(s, s.normal, s.draco_normal, i, n)) v.normal = transform.normal({n[0], n[1], n[2]});
      v.colour = fetch(s, s.colour, s.draco_colour, i, c) ? stored_colour(c) : plain_colour;
      if (fetch(s, s.texcoord, s.draco_texcoord, i, t)) {
        v.texcoord = {static_cast<float>(t[0]), static_cast<float>(1 - t[1])};
      }
      CUESTA_TRY(out_.vertex(v));
    }
    if (s.vertices > 0)
      passed_vertices(s, (s.vertices - 1) / release_elements * release_elements, s.vertices);
    out_.set_vertex_count(first_vertex_ + s.vertices);
    return {};
  }

  Result<void> emit_triangles(const Streams& s, Mode mode, bool mirrored) {
    const std::uint64_t corners = s.draco     ? std::uint64_t{3} * s.draco->triangles()
                                  : s.indices ? s.indices->count
                                              : s.vertices;
    const auto corner = [&](std::uint64_t i) {
      const std::uint64_t local = s.draco     ? s.draco->triangle(static_cast<std::uint32_t>(i / 3))[i % 3]
                                  : s.indices ? s.indices->index(i)
                                              : i;
      return local < s.vertices ? first_vertex_ + local : ~std::uint64_t{0};
    };
    if (s.draco) mode = Mode::triangles;  // Draco data holds triangles, also where the primitive was a strip
    const std::uint64_t triangles = mode == Mode::triangles ? corners / 3 : corners < 3 ? 0 : corners - 2;
    const auto first_corner = [mode](std::uint64_t t) { return mode == Mode::triangles ? 3 * t : t; };
    std::uint64_t first_held = 0;
    for (std::uint64_t t = 0; t < triangles; ++t) {
      if (t % release_elements == 0) {
        passed(s.indices, first_held, first_corner(t));
        first_held = first_corner(t);
      }
      std::array<std::uint64_t, 3> c{};
      switch (mode) {
        case Mode::strip:
          c = {corner(t), corner(t + 1 + t % 2), corner(t + 2 - t % 2)};
          break;
        case Mode::fan:
          c = {corner(t + 1), corner(t + 2), corner(0)};
          break;
        default:
          c = {corner(3 * t), corner(3 * t + 1), corner(3 * t + 2)};
          break;
      }
      const bool stitch = mode == Mode::strip && (c[0] == c[1] || c[1] == c[2] || c[2] == c[0]);
      if (stitch) continue;
      if (mirrored) std::swap(c[1], c[2]);
      CUESTA_TRY(out_.triangle(c[0], c[1], c[2]));
    }
    passed(s.indices, first_held, corners);
    return {};
  }

  const ReadJob& job_;
  const Document& document_;
  Data data_;
  MeshEmitter out_;
  std::uint64_t first_vertex_ = 0;
  std::array<float, 4> base_colour_{1, 1, 1, 1};
};

}  // namespace
}  // namespace gltf

Result<ReadReport> read_gltf(const ReadJob& job) {
  const auto chunks = gltf::chunks_of(job);
  if (!chunks) return fail(chunks.error());
  CUESTA_TRY(job.budget.charge(chunks->json.size(), 1, "bytes of JSON"));
  const auto document = gltf::parse(job, chunks->json);
  if (!document) return fail(document.error());
  job.budget.release(chunks->json.size());
  if (job.window) job.window->release_all();
  return gltf::Reader(job, *document, chunks->binary).read();
}

}  // namespace cuesta
