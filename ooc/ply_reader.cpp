/// PLY. Vertices are read first, wherever they are in the file, then faces and strips in file order.
/// Binary vertices without lists have rows of one size: their columns are gathered straight from the map into
/// the sink's block, one typed loop per property; everything else goes value by value.

#include <fmt/format.h>

#include <algorithm>
#include <array>

#include "ooc/cached_file.h"
#include "ooc/mesh_emitter.h"
#include "ooc/ply_header.h"
#include "ooc/ply_source.h"
#include "ooc/spilled_table.h"

namespace cuesta {
namespace {

static_assert(std::endian::native == std::endian::little, "binary files are read in place");

/// What look-ups may hold of the file beside the memory that was allowed.
constexpr std::uint64_t least_look_up_bytes = std::uint64_t{2} << 20;

/// What the vertex properties mean: their index in the element, or -1.
struct VertexRoles {
  std::array<int, 3> position{-1, -1, -1};
  std::array<int, 3> normal{-1, -1, -1};
  std::array<int, 4> colour{-1, -1, -1, -1};
  std::array<int, 2> texcoord{-1, -1};

  AttributeSet attributes() const {
    return {.normals = normal[0] >= 0, .colours = colour[0] >= 0, .texcoords = texcoord[0] >= 0};
  }
};

template <std::size_t N>
bool find_all(const PlyElement& element, const std::array<std::string_view, N>& names,
              std::array<int, N>& roles) {
  std::array<int, N> found{};
  for (std::size_t i = 0; i < N; ++i) {
    found[i] = element.find(names[i]);
    if (found[i] < 0 || element.properties[static_cast<std::size_t>(found[i])].list_count) return false;
  }
  roles = found;
  return true;
}

VertexRoles roles_of(const PlyElement& element) {
  VertexRoles roles;
  find_all<3>(element, {"x", "y", "z"}, roles.position);
  find_all<3>(element, {"nx", "ny", "nz"}, roles.normal);
  if (!find_all<4>(element, {"red", "green", "blue", "alpha"}, roles.colour)) {
    std::array<int, 3> rgb{-1, -1, -1};
    find_all<3>(element, {"red", "green", "blue"}, rgb);
    std::copy(rgb.begin(), rgb.end(), roles.colour.begin());
  }
  find_all<2>(element, {"s", "t"}, roles.texcoord) || find_all<2>(element, {"u", "v"}, roles.texcoord) ||
      find_all<2>(element, {"texture_u", "texture_v"}, roles.texcoord);
  return roles;
}

/// Whole colours are 0…255 (16 bits: 0…65535), real ones 0…1.
double colour_scale(PlyType type) {
  return is_real(type) ? 255.0 : type == PlyType::u16 ? 255.0 / 65535 : 1.0;
}

/// One property of `rows` rows of `stride` bytes, into every `step`-th element from `out` on.
template <bool swapped, class Out>
void gather(PlyType type, const char* at, std::uint64_t stride, std::size_t rows, Out* out,
            std::size_t step) {
  with_ply_type(type, [=](auto zero) {
    for (std::size_t i = 0; i < rows; ++i) {
      out[i * step] = static_cast<Out>(load_ply<decltype(zero), swapped>(at + i * stride));
    }
  });
}

template <bool swapped>
void gather_colour(PlyType type, const char* at, std::uint64_t stride, std::size_t rows, Rgba8* out,
                   std::size_t k) {
  const double scale = colour_scale(type);
  if (type == PlyType::u8) {
    for (std::size_t i = 0; i < rows; ++i) out[i][k] = static_cast<std::uint8_t>(at[i * stride]);
    return;
  }
  with_ply_type(type, [=](auto zero) {
    for (std::size_t i = 0; i < rows; ++i) {
      out[i][k] =
          colour_byte(static_cast<double>(load_ply<decltype(zero), swapped>(at + i * stride)) * scale);
    }
  });
}

void make_unit(Vec3f* normals, std::size_t count) {
  for (std::size_t i = 0; i < count; ++i) normals[i] = normalized(normals[i]);
}

template <class Source>
class PlyReader {
 public:
  PlyReader(const ReadJob& job, const PlyHeader& header, const PlyElement& vertices)
      : job_(job),
        header_(header),
        vertices_(vertices),
        roles_(roles_of(vertices)),
        out_(job, roles_.attributes()),
        positions_(job, "vertex positions") {}

  Result<ReadReport> read() {
    if (roles_.position[0] < 0) return job_.corrupt_at(0, "the vertex element has no x, y and z");
    Source source{job_.bytes.data() + header_.data_byte, job_.bytes.data() + job_.bytes.size()};
    const Source first = source;
    const std::size_t vertex_element = static_cast<std::size_t>(&vertices_ - header_.elements.data());
    for (std::size_t i = 0; i < vertex_element; ++i) CUESTA_TRY(skip_element(source, header_.elements[i]));
    CUESTA_TRY(check_room(source, vertices_));
    if (job_.expect) CUESTA_TRY(job_.expect(vertices_.count, expected_faces()));
    out_.set_vertex_count(vertices_.count);
    CUESTA_TRY(read_vertices(source));
    CUESTA_TRY(out_.flush_vertices());
    const Source past_vertices = source;
    source = first;
    for (std::size_t i = 0; i < header_.elements.size(); ++i) {
      if (i == vertex_element) {
        source = past_vertices;
      } else if (i < vertex_element || i <= last_face_element()) {
        CUESTA_TRY(read_other_element(source, header_.elements[i]));
      }
    }
    return out_.finish();
  }

 private:
  static bool is_face(const PlyElement& e) { return e.name == "face"; }
  static bool is_strips(const PlyElement& e) { return e.name == "tristrips"; }
  static int index_list(const PlyElement& e) {
    for (const char* name : {"vertex_indices", "vertex_index"}) {
      const int found = e.find(name);
      if (found >= 0 && e.properties[static_cast<std::size_t>(found)].list_count) return found;
    }
    return -1;
  }
  /// What comes after the last faces need not be read, nor be whole.
  std::size_t last_face_element() const {
    std::size_t last = 0;
    for (std::size_t i = 0; i < header_.elements.size(); ++i) {
      if (is_face(header_.elements[i]) || is_strips(header_.elements[i])) last = i;
    }
    return last;
  }
  std::uint64_t expected_faces() const {
    std::uint64_t count = 0;
    for (const PlyElement& e : header_.elements) {
      if (is_face(e) && e.count <= job_.bytes.size()) count += e.count;
    }
    return count;
  }

  std::uint64_t byte(const Source& source) const {
    return static_cast<std::uint64_t>(source.at - job_.bytes.data());
  }
  tl::unexpected<Error> corrupt(const Source& source, const std::string& what) const {
    if constexpr (Source::ascii) {
      const char* place = source.at;
      return job_.corrupt_line(place, what);
    } else {
      return job_.corrupt_at(byte(source), what);
    }
  }
  tl::unexpected<Error> bad_row(const Source& source, const PlyElement& element, std::uint64_t row) const {
    return corrupt(source, fmt::format("expected {} of {} rows of element {}, found {}", row + 1,
                                       element.count, quote_word(element.name),
                                       source.left() < 64 ? "the end of the file" : "something else"));
  }

  /// Counts are checked before anything is allocated or looped over for them.
  Result<void> check_room(const Source& source, const PlyElement& element) const {
    const std::uint64_t least = element.least_row_bytes(Source::ascii);
    if (least == 0 || element.count <= (source.left() + 1) / least) return {};
    return corrupt(source,
                   fmt::format("expected {} rows of element {}, at least {} bytes each, found {} bytes",
                               element.count, quote_word(element.name), least, source.left()));
  }

  Result<void> skip_element(Source& source, const PlyElement& element) {
    CUESTA_TRY(check_room(source, element));
    if (element.properties.empty()) return {};
    if (const auto row = element.row_bytes(); row && !Source::ascii) {
      source.at += element.count * *row;
      return {};
    }
    for (std::uint64_t i = 0; i < element.count; ++i) {
      for (const PlyProperty& p : element.properties) {
        if (!skip_property(source, p)) return bad_row(source, element, i);
      }
      job_.passed(source.at);
      CUESTA_TRY(tick(source, i));
    }
    return {};
  }
  static bool skip_property(Source& source, const PlyProperty& p) {
    if (!p.list_count) return source.skip(p.type, 1);
    std::int64_t count = 0;
    return source.whole(*p.list_count, count) && count >= 0 &&
           source.skip(p.type, static_cast<std::uint64_t>(count));
  }
  Result<void> tick(const Source& source, std::uint64_t row) {
    if (row % MeshEmitter::block_elements != MeshEmitter::block_elements - 1) return {};
    out_.at_byte(byte(source));
    return job_.report_progress(byte(source));
  }

  Result<void> read_vertices(Source& source) {
    if constexpr (!Source::ascii) {
      if (const auto row = vertices_.row_bytes()) return gather_vertices(source, *row);
    }
    return parse_vertices(source);
  }

  Result<void> gather_vertices(Source& source, std::uint64_t row) {
    constexpr bool swapped = !std::is_same_v<Source, PlyBytes<false>>;
    std::vector<std::uint64_t> offsets;
    for (std::uint64_t at = 0; const PlyProperty& p : vertices_.properties) {
      offsets.push_back(at);
      at += ply_bytes(p.type);
    }
    const auto column = [&](int role, auto&& use) {
      const std::size_t i = static_cast<std::size_t>(role);
      use(vertices_.properties[i].type, source.at + offsets[i]);
    };
    const char* rows = source.at;
    for (std::uint64_t done = 0; done < vertices_.count;) {
      // Small enough that the rows stay in the first-level caches from one column to the next.
      const std::size_t wanted =
          static_cast<std::size_t>(std::min<std::uint64_t>(1024, vertices_.count - done));
      const MeshEmitter::Columns c = out_.columns(wanted);
      for (std::size_t k = 0; k < 3; ++k) {
        column(roles_.position[k], [&](PlyType type, const char* at) {
          gather<swapped>(type, at, row, c.count, &c.positions->x + k, 3);
        });
        if (c.normals)
          column(roles_.normal[k], [&](PlyType type, const char* at) {
            gather<swapped>(type, at, row, c.count, &c.normals->x + k, 3);
          });
      }
      if (c.normals) make_unit(c.normals, c.count);
      if (c.colours) {
        if (roles_.colour[3] < 0) std::fill_n(c.colours, c.count, Rgba8{255, 255, 255, 255});
        for (std::size_t k = 0; k < 4 && roles_.colour[k] >= 0; ++k) {
          column(roles_.colour[k], [&](PlyType type, const char* at) {
            gather_colour<swapped>(type, at, row, c.count, c.colours, k);
          });
        }
      }
      for (std::size_t k = 0; c.texcoords && k < 2; ++k) {
        column(roles_.texcoord[k], [&](PlyType type, const char* at) {
          gather<swapped>(type, at, row, c.count, c.texcoords->data() + k, 2);
        });
      }
      source.at += c.count * row;
      done += c.count;
      out_.at_byte(byte(source));
      job_.passed(source.at);
      CUESTA_TRY(out_.commit_vertices(c.count));
    }
    if (expected_faces() > 0) CUESTA_TRY(prepare_look_ups(rows, vertices_.count * row));
    std::array<std::uint64_t, 3> at{};  // of x, y, z in a row
    std::array<PlyType, 3> types{};
    std::uint64_t past = 0;
    for (std::size_t k = 0; k < 3; ++k) {
      const std::size_t property = static_cast<std::size_t>(roles_.position[k]);
      at[k] = offsets[property];
      types[k] = vertices_.properties[property].type;
      past = std::max(past, at[k] + ply_bytes(types[k]));
    }
    const std::uint64_t first = std::min({at[0], at[1], at[2]});
    look_up_.resize(past - first);
    out_.set_positions([=, this](std::size_t, std::uint64_t i) -> Result<Vec3d> {
      const char* from = rows + i * row + first;
      if (look_ups_) {
        CUESTA_TRY(look_ups_->read(static_cast<std::uint64_t>(from - job_.bytes.data()), look_up_));
        from = look_up_.data();
      }
      Vec3d p;
      for (std::size_t k = 0; k < 3; ++k)
        gather<swapped>(types[k], from + (at[k] - first), row, 1, &p[static_cast<int>(k)], 1);
      return p;
    });
    return {};
  }

  /// Polygons look the positions of their vertices up: in the map, if all of these may stay in memory, else
  /// in the file. A sink that holds the mesh itself is left more of the memory.
  Result<void> prepare_look_ups(const char* rows, std::uint64_t row_bytes) {
    if (!job_.file) return {};
    const std::uint64_t share = job_.budget.left() / (job_.expect ? 8 : 2);
    if (row_bytes <= least_look_up_bytes) return {};
    if (row_bytes + 2 * MappedFile::fault_bytes <= share)
      return job_.budget.charge(row_bytes + 2 * MappedFile::fault_bytes, 1, "bytes of vertices");
    const std::uint64_t places = std::max(share, least_look_up_bytes) / CachedFile::default_page_bytes;
    CUESTA_TRY(job_.budget.charge(share, 1, "bytes of vertices"));
    look_ups_.emplace([this](std::uint64_t at, std::span<char> into) { return job_.file->read(at, into); },
                      CachedFile::default_page_bytes, places);
    look_ups_->set_bytes(static_cast<std::uint64_t>(rows - job_.bytes.data()) + row_bytes);
    return {};
  }

  /// Rows of text or with lists: positions are kept for polygons, if there are faces at all.
  Result<void> parse_vertices(Source& source) {
    const bool keep = expected_faces() > 0;
    positions_.keep_free(job_.budget.left() / 2);
    std::vector<double> values(vertices_.properties.size());
    for (std::uint64_t i = 0; i < vertices_.count; ++i) {
      for (std::size_t k = 0; k < values.size(); ++k) {
        const PlyProperty& p = vertices_.properties[k];
        const bool good = p.list_count ? skip_property(source, p) : source.real(p.type, values[k]);
        if (!good) return bad_row(source, vertices_, i);
      }
      const Vertex v = vertex_of(values);
      if (keep) CUESTA_TRY(positions_.append(v.position));
      out_.at_byte(byte(source));
      job_.passed(source.at);
      CUESTA_TRY(out_.vertex(v));
    }
    out_.set_positions([this](std::size_t, std::uint64_t vertex) { return positions_.get(vertex); });
    return {};
  }

  Vertex vertex_of(const std::vector<double>& values) const {
    const auto value = [&](int role) { return values[static_cast<std::size_t>(role)]; };
    Vertex v;
    v.position = {value(roles_.position[0]), value(roles_.position[1]), value(roles_.position[2])};
    if (roles_.normal[0] >= 0) {
      v.normal = normalized(
          vec_cast<float>(Vec3d{value(roles_.normal[0]), value(roles_.normal[1]), value(roles_.normal[2])}));
    }
    for (std::size_t k = 0; k < 4 && roles_.colour[k] >= 0; ++k) {
      const std::size_t property = static_cast<std::size_t>(roles_.colour[k]);
      v.colour[k] = colour_byte(values[property] * colour_scale(vertices_.properties[property].type));
    }
    if (roles_.texcoord[0] >= 0) {
      v.texcoord = {static_cast<float>(value(roles_.texcoord[0])),
                    static_cast<float>(value(roles_.texcoord[1]))};
    }
    return v;
  }

  Result<void> read_other_element(Source& source, const PlyElement& element) {
    const int list = index_list(element);
    if (list < 0 || !(is_face(element) || is_strips(element))) return skip_element(source, element);
    CUESTA_TRY(check_room(source, element));
    for (std::uint64_t i = 0; i < element.count; ++i) {
      for (std::size_t k = 0; k < element.properties.size(); ++k) {
        const PlyProperty& p = element.properties[k];
        if (static_cast<int>(k) != list) {
          if (!skip_property(source, p)) return bad_row(source, element, i);
          continue;
        }
        std::int64_t count = 0;
        if (!source.whole(*p.list_count, count) || count < 0 ||
            !source.has(p.type, static_cast<std::uint64_t>(count))) {
          return bad_row(source, element, i);
        }
        CUESTA_TRY(is_face(element) ? read_face(source, p.type, count) : read_strip(source, p.type, count));
      }
      job_.passed(source.at);
      CUESTA_TRY(tick(source, i));
    }
    return {};
  }

  Result<void> read_face(Source& source, PlyType type, std::int64_t count) {
    if (count == 3) {
      std::array<std::int64_t, 3> t{};
      for (std::int64_t& corner : t) {
        if (!source.whole(type, corner)) return corrupt(source, "expected the index of a vertex");
      }
      out_.at_byte(byte(source));  // a negative index becomes out of range
      return out_.triangle(static_cast<std::uint64_t>(t[0]), static_cast<std::uint64_t>(t[1]),
                           static_cast<std::uint64_t>(t[2]));
    }
    CUESTA_TRY(out_.expect_corners(static_cast<std::uint64_t>(count)));
    corners_.clear();
    for (std::int64_t k = 0; k < count; ++k) {
      std::int64_t corner = 0;
      if (!source.whole(type, corner)) return corrupt(source, "expected the index of a vertex");
      corners_.push_back(static_cast<std::uint64_t>(corner));
    }
    out_.at_byte(byte(source));
    return out_.face(corners_);
  }

  /// Triangle k of a strip is (k, k+1, k+2), every second one turned round; -1 ends a strip. Triangles that
  /// use a vertex twice only stitch strips together.
  Result<void> read_strip(Source& source, PlyType type, std::int64_t count) {
    std::array<std::int64_t, 2> last{};
    std::uint64_t held = 0;
    for (std::int64_t k = 0; k < count; ++k) {
      std::int64_t c = 0;
      if (!source.whole(type, c)) return corrupt(source, "expected the index of a vertex of a strip");
      if (c < 0) {
        held = 0;
        continue;
      }
      if (held >= 2 && c != last[0] && c != last[1] && last[0] != last[1]) {
        const bool turned = held % 2 == 1;
        const std::uint64_t a = static_cast<std::uint64_t>(last[turned ? 1 : 0]);
        const std::uint64_t b = static_cast<std::uint64_t>(last[turned ? 0 : 1]);
        out_.at_byte(byte(source));
        CUESTA_TRY(out_.triangle(a, b, static_cast<std::uint64_t>(c)));
      }
      last = {last[1], c};
      ++held;
      job_.passed(source.at);
      CUESTA_TRY(tick(source, static_cast<std::uint64_t>(k)));
    }
    return {};
  }

  const ReadJob& job_;
  const PlyHeader& header_;
  const PlyElement& vertices_;
  VertexRoles roles_;
  MeshEmitter out_;
  std::optional<CachedFile> look_ups_;
  std::vector<char> look_up_;      ///< x, y and z of a row, with what is between them
  SpilledTable<Vec3d> positions_;  ///< of rows that are not in the map one by one
  std::vector<std::uint64_t> corners_;
};

}  // namespace

Result<ReadReport> read_ply(const ReadJob& job) {
  const auto header = parse_ply_header(job);
  if (!header) return fail(header.error());
  for (const PlyElement& element : header->elements) {
    if (element.name != "vertex") continue;
    switch (header->encoding) {
      case PlyEncoding::ascii:
        return PlyReader<PlyText>(job, *header, element).read();
      case PlyEncoding::little_endian:
        return PlyReader<PlyBytes<false>>(job, *header, element).read();
      case PlyEncoding::big_endian:
        return PlyReader<PlyBytes<true>>(job, *header, element).read();
    }
  }
  return job.corrupt_at(0, "the header has no vertex element");
}

}  // namespace cuesta
