/// Wavefront OBJ: v (with colours), vn, vt, f. Two passes over the mapped text, vertex data and faces, as
/// faces may name later vertices. Vertex data are kept in tables that spill to a temporary file.

#include <fmt/format.h>

#include "ooc/corner_map.h"
#include "ooc/mesh_emitter.h"
#include "ooc/spilled_table.h"
#include "ooc/text_cursor.h"

namespace cuesta {
namespace {

constexpr std::uint64_t progress_lines = std::uint64_t{1} << 16;

/// One statement: the cursor spans the line, with the lines that a backslash joins to it.
class Statements {
 public:
  explicit Statements(std::span<const char> bytes) : at_(bytes.data()), end_(bytes.data() + bytes.size()) {}

  bool next(TextCursor& line) {
    if (at_ == end_) return false;
    TextCursor rest{at_, end_};
    do {
      rest.skip_line();
    } while (rest.at != end_ && is_continued(at_, rest.at));
    line = {at_, rest.at};
    at_ = rest.at;
    return true;
  }
  const char* at() const { return at_; }

 private:
  static bool is_continued(const char* first, const char* past_newline) {
    const char* last = past_newline - 1;
    if (last != first && last[-1] == '\r') --last;
    return last != first && last[-1] == '\\';
  }
  const char* at_;
  const char* end_;
};

/// Blanks, and backslashes before a newline.
void skip_gap(TextCursor& line) {
  while (!line.done() && (TextCursor::is_space(*line.at) || *line.at == '\\')) ++line.at;
}

enum class Keyword { other, v, vn, vt, f };

Keyword keyword(TextCursor& line) {
  line.skip_blanks();
  const std::string_view word = line.word();
  if (word == "v") return Keyword::v;
  if (word == "vn") return Keyword::vn;
  if (word == "vt") return Keyword::vt;
  if (word == "f") return Keyword::f;
  return Keyword::other;
}

class ObjReader {
 public:
  /// A third of the memory for vertex data; the corner map leaves an eighth for the caches of what was
  /// spilled and for polygons.
  explicit ObjReader(const ReadJob& job)
      : job_(job),
        positions_(job, "vertex positions"),
        colours_(job, "colours"),
        normals_(job, "normals"),
        texcoords_(job, "texture coordinates"),
        corner_map_(job.budget, job.budget.left() / 8) {
    const std::uint64_t keep_free = job.budget.left() / 3 * 2;
    positions_.keep_free(keep_free);
    colours_.keep_free(keep_free);
    normals_.keep_free(keep_free);
    texcoords_.keep_free(keep_free);
  }

  Result<ReadReport> read() {
    CUESTA_TRY(read_vertex_data());
    // Without vn and vt a vertex is its v, used or not; otherwise a vertex is a distinct corner of a face.
    const bool plain = normals_.empty() && texcoords_.empty();
    MeshEmitter out(
        job_, {.normals = !normals_.empty(), .colours = !colours_.empty(), .texcoords = !texcoords_.empty()});
    out.set_positions(
        [this](std::size_t corner, std::uint64_t) { return positions_.get(corners_[corner].v); });
    if (plain) {
      if (job_.expect) CUESTA_TRY(job_.expect(positions_.size(), face_lines_));
      for (std::uint64_t i = 0; i < positions_.size(); ++i) CUESTA_TRY(emit({i, none, none}, out));
      out.set_vertex_count(positions_.size());
    }
    CUESTA_TRY(read_faces(out, plain));
    return out.finish();
  }

 private:
  static constexpr std::uint64_t none = ~std::uint64_t{0};  ///< the corner does not name one

  Result<void> read_vertex_data() {
    Statements statements(job_.bytes);
    TextCursor line;
    for (std::uint64_t n = 1; statements.next(line); ++n) {
      const Keyword word = keyword(line);
      if (word == Keyword::v) CUESTA_TRY(read_position(line));
      if (word == Keyword::vn) CUESTA_TRY(read_normal(line));
      if (word == Keyword::vt) CUESTA_TRY(read_texcoord(line));
      if (word == Keyword::f) ++face_lines_;
      job_.passed(statements.at());
      if (n % progress_lines == 0) CUESTA_TRY(job_.report_progress(byte(statements.at()) / 2));
    }
    return {};
  }
  std::uint64_t byte(const char* at) const { return static_cast<std::uint64_t>(at - job_.bytes.data()); }

  /// Up to N numbers; what is no number (a comment, for example) ends them.
  template <std::size_t N>
  static std::size_t numbers(TextCursor& line, std::array<double, N>& values) {
    std::size_t n = 0;
    while (n < N) {
      skip_gap(line);
      const std::optional<double> value = line.real();
      if (!value) break;
      values[n++] = *value;
    }
    return n;
  }

  Result<void> read_position(TextCursor& line) {
    std::array<double, 7> v{};
    const std::size_t n = numbers(line, v);
    if (n < 3) return job_.corrupt_line(line.at, "expected three coordinates after \"v\"");
    CUESTA_TRY(positions_.append({v[0], v[1], v[2]}));
    if (n < 6) return {};  // a fourth number is a weight of curves
    while (colours_.size() + 1 < positions_.size()) CUESTA_TRY(colours_.append({255, 255, 255, 255}));
    return colours_.append({colour_byte(v[3] * 255), colour_byte(v[4] * 255), colour_byte(v[5] * 255),
                            n == 7 ? colour_byte(v[6] * 255) : std::uint8_t{255}});
  }
  Result<void> read_normal(TextCursor& line) {
    std::array<double, 3> v{};
    if (numbers(line, v) < 3) return job_.corrupt_line(line.at, "expected three components after \"vn\"");
    return normals_.append(vec_cast<float>(normalized(Vec3d{v[0], v[1], v[2]})));
  }
  Result<void> read_texcoord(TextCursor& line) {
    std::array<double, 2> v{};
    if (numbers(line, v) < 1) return job_.corrupt_line(line.at, "expected coordinates after \"vt\"");
    return texcoords_.append({static_cast<float>(v[0]), static_cast<float>(v[1])});
  }

  struct Corner {
    std::uint64_t v, vt, vn;
  };

  template <class T>
  static Result<void> look_up(SpilledTable<T>& table, std::uint64_t i, T& value) {
    auto found = table.get(i);
    if (!found) return fail(std::move(found).error());
    value = *found;
    return {};
  }
  Result<void> emit(const Corner& c, MeshEmitter& out) {
    Vertex v;
    CUESTA_TRY(look_up(positions_, c.v, v.position));
    if (c.vn != none) CUESTA_TRY(look_up(normals_, c.vn, v.normal));
    if (c.v < colours_.size()) CUESTA_TRY(look_up(colours_, c.v, v.colour));
    if (c.vt != none) CUESTA_TRY(look_up(texcoords_, c.vt, v.texcoord));
    return out.vertex(v);
  }

  Result<void> read_faces(MeshEmitter& out, bool plain) {
    Statements statements(job_.bytes);
    TextCursor line;
    for (std::uint64_t n = 1; statements.next(line); ++n) {
      switch (keyword(line)) {
        case Keyword::v:
          ++seen_positions_;
          break;
        case Keyword::vt:
          ++seen_texcoords_;
          break;
        case Keyword::vn:
          ++seen_normals_;
          break;
        case Keyword::f:
          CUESTA_TRY(read_face(line, out, plain));
          break;
        case Keyword::other:
          break;
      }
      const std::uint64_t done = (job_.bytes.size() + byte(statements.at())) / 2;
      out.at_byte(done);
      job_.passed(statements.at());
      if (n % progress_lines == 0) CUESTA_TRY(job_.report_progress(done));
    }
    return {};
  }

  Result<void> read_face(TextCursor& line, MeshEmitter& out, bool plain) {
    corners_.clear();
    bool in_range = true;
    for (skip_gap(line); !line.done() && *line.at != '#'; skip_gap(line)) {
      CUESTA_TRY(out.expect_corners(corners_.size() + 1));
      Corner corner{};
      CUESTA_TRY(read_corner(line, corner, in_range));
      corners_.push_back(corner);
    }
    indices_.clear();
    for (const Corner& corner : corners_) {
      if (!in_range) {
        indices_.push_back(none);
      } else if (plain) {
        indices_.push_back(corner.v);
      } else {
        auto index = distinct_vertex(corner, out);
        if (!index) return fail(std::move(index).error());
        indices_.push_back(*index);
      }
    }
    return out.face(indices_);
  }

  /// v, v/vt, v//vn or v/vt/vn; negative numbers count back from the last one defined above this line.
  Result<void> read_corner(TextCursor& line, Corner& corner, bool& in_range) {
    const auto resolve = [&in_range](std::int64_t written, std::uint64_t seen, std::uint64_t size) {
      const std::uint64_t index =
          written > 0 ? static_cast<std::uint64_t>(written) - 1 : seen + static_cast<std::uint64_t>(written);
      if (written == 0 || index >= size) in_range = false;
      return index;
    };
    const std::optional<std::int64_t> v = line.integer();
    if (!v) return job_.corrupt_line(line.at, "expected a corner such as 1, 1/2, 1//3 or 1/2/3");
    corner = {resolve(*v, seen_positions_, positions_.size()), none, none};
    if (!line.done() && *line.at == '/') {
      ++line.at;
      if (const auto vt = line.integer()) corner.vt = resolve(*vt, seen_texcoords_, texcoords_.size());
    }
    if (!line.done() && *line.at == '/') {
      ++line.at;
      if (const auto vn = line.integer()) corner.vn = resolve(*vn, seen_normals_, normals_.size());
    }
    if (!line.at_word_end() && *line.at != '\\') {
      return job_.corrupt_line(line.at, "expected a corner such as 1, 1/2, 1//3 or 1/2/3");
    }
    return {};
  }

  Result<std::uint64_t> distinct_vertex(const Corner& corner, MeshEmitter& out) {
    const auto found = corner_map_.find_or_add({corner.v, corner.vt, corner.vn}, distinct_vertices_);
    if (found.is_new) {
      CUESTA_TRY(emit(corner, out));
      out.set_vertex_count(++distinct_vertices_);
    }
    return found.index;
  }

  const ReadJob& job_;
  std::uint64_t face_lines_ = 0, distinct_vertices_ = 0;
  std::uint64_t seen_positions_ = 0, seen_normals_ = 0, seen_texcoords_ = 0;
  SpilledTable<Vec3d> positions_;
  SpilledTable<Rgba8> colours_;  ///< shorter than positions_ when the last ones have none
  SpilledTable<Vec3f> normals_;
  SpilledTable<TexCoord> texcoords_;
  std::vector<Corner> corners_;
  std::vector<std::uint64_t> indices_;
  CornerMap corner_map_;
};

}  // namespace

Result<ReadReport> read_obj(const ReadJob& job) {
  return ObjReader(job).read();
}

}  // namespace cuesta
