#include "ooc/gltf_primitive.h"

#include <fmt/format.h>

#include <algorithm>

#include "ooc/draco_mesh.h"
#include "ooc/gltf_data.h"
#include "ooc/srgb.h"

namespace cuesta::gltf {
namespace {

/// Vertices or triangles after which what they were read from is released: of 12 bytes, 768 KiB.
constexpr std::uint64_t release_elements = std::uint64_t{1} << 16;

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

/// One primitive on its way out.
class Emission {
 public:
  Emission(const ReadJob& job, const Document& document, Data& data, const std::array<float, 4>& base_colour,
           std::uint64_t first_vertex, MeshEmitter& out)
      : job_(job),
        document_(document),
        data_(data),
        out_(out),
        first_vertex_(first_vertex),
        base_colour_(base_colour) {}

  Result<std::uint64_t> run(const Primitive& p, std::span<const Affine> placed) {
    data_.forget_decoded();
    auto streams = load(p);
    if (!streams) return fail(std::move(streams).error());
    for (const Affine& transform : placed) {
      CUESTA_TRY(emit_vertices(*streams, transform));
      CUESTA_TRY(emit_triangles(*streams, p.mode, determinant(transform) < 0));
      first_vertex_ += streams->vertices;
    }
    return first_vertex_;
  }

 private:
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

  Rgba8 tinted(const std::array<double, 4>& vertex_colour) const {
    std::array<double, 4> linear{};
    for (std::size_t k = 0; k < 4; ++k) linear[k] = vertex_colour[k] * static_cast<double>(base_colour_[k]);
    return stored_colour(linear);
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

  Result<void> emit_vertices(const Streams& s, const Affine& transform) {
    const Rgba8 plain_colour = tinted({1, 1, 1, 1});
    for (std::uint64_t i = 0; i < s.vertices; ++i) {
      if (i % release_elements == 0 && i > 0) passed_vertices(s, i - release_elements, i);
      Vertex v;
      std::array<double, 3> p{}, n{};
      std::array<double, 4> c{1, 1, 1, 1};
      std::array<double, 2> t{};
      fetch(s, s.position, s.draco_position, i, p);
      v.position = transform.point({p[0], p[1], p[2]});
      if (fetch(s, s.normal, s.draco_normal, i, n))
        v.normal = vec_cast<float>(normalized(map_normal(transform, {n[0], n[1], n[2]})));
      v.colour = fetch(s, s.colour, s.draco_colour, i, c) ? tinted(c) : plain_colour;
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
  Data& data_;
  MeshEmitter& out_;
  std::uint64_t first_vertex_;
  const std::array<float, 4>& base_colour_;
};

}  // namespace

Rgba8 stored_colour(const std::array<double, 4>& linear) {
  Rgba8 colour{};
  for (std::size_t k = 0; k < 4; ++k) {
    const double value = std::clamp(linear[k], 0.0, 1.0);
    colour[k] = colour_byte(255 * (k == 3 ? value : srgb_from_linear(value)));
  }
  return colour;
}

bool is_surface(const Primitive& p) {
  return p.mode != Mode::other && (p.position != none || p.draco);
}

Result<std::uint64_t> emit_primitive(const ReadJob& job, const Document& document, Data& data,
                                     const Primitive& primitive, const std::array<float, 4>& base_colour,
                                     std::span<const Affine> placed, std::uint64_t first_vertex,
                                     MeshEmitter& out) {
  return Emission(job, document, data, base_colour, first_vertex, out).run(primitive, placed);
}

}  // namespace cuesta::gltf
