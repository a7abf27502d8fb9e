/// Wavefront OBJ: v (with colours), vn, vt, f. Three passes over the mapped text: count, read the vertex
/// data, read the faces, so that every array is charged and allocated once and faces may name later vertices.

#include <fmt/format.h>

#include "ooc/corner_map.h"
#include "ooc/mesh_emitter.h"
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
  explicit ObjReader(const ReadJob& job) : job_(job) {}

  Result<ReadReport> read() {
    CUESTA_TRY(count());
    CUESTA_TRY(reserve());
    CUESTA_TRY(read_vertex_data());
    // Without vn and vt a vertex is its v, used or not; otherwise a vertex is a distinct corner of a face.
    const bool plain = normals_.empty() && texcoords_.empty();
    MeshEmitter out(
        job_, {.normals = !normals_.empty(), .colours = has_colours_, .texcoords = !texcoords_.empty()});
    if (plain) {
      if (job_.expect) CUESTA_TRY(job_.expect(positions_.size(), face_lines_));
      for (std::size_t i = 0; i < positions_.size(); ++i) CUESTA_TRY(out.vertex(vertex({i, none, none})));
      out.set_positions([this](std::uint64_t i) { return positions_[i]; });
      out.set_vertex_count(positions_.size());
    } else {
      out.set_positions([this](std::uint64_t i) { return positions_[corner_positions_[i]]; });
    }
    CUESTA_TRY(read_faces(out, plain));
    return out.finish();
  }

 private:
  static constexpr std::uint64_t none = ~std::uint64_t{0};  ///< the corner does not name one

  Result<void> count() {
    Statements statements(job_.bytes);
    TextCursor line;
    while (statements.next(line)) {
      const Keyword word = keyword(line);
      if (word == Keyword::v) ++position_lines_;
      if (word == Keyword::vn) ++normal_lines_;
      if (word == Keyword::vt) ++texcoord_lines_;
      if (word == Keyword::f) ++face_lines_;
    }
    return {};
  }

  Result<void> reserve() {
    CUESTA_TRY(job_.budget.charge(position_lines_, sizeof(Vec3d) + sizeof(Rgba8), "vertex positions"));
    CUESTA_TRY(job_.budget.charge(normal_lines_, sizeof(Vec3f), "normals"));
    CUESTA_TRY(job_.budget.charge(texcoord_lines_, sizeof(TexCoord), "texture coordinates"));
    positions_.reserve(position_lines_);
    normals_.reserve(normal_lines_);
    texcoords_.reserve(texcoord_lines_);
    return {};
  }

  Result<void> read_vertex_data() {
    Statements statements(job_.bytes);
    TextCursor line;
    for (std::uint64_t n = 1; statements.next(line); ++n) {
      const Keyword word = keyword(line);
      if (word == Keyword::v) CUESTA_TRY(read_position(line));
      if (word == Keyword::vn) CUESTA_TRY(read_normal(line));
      if (word == Keyword::vt) CUESTA_TRY(read_texcoord(line));
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
    positions_.push_back({v[0], v[1], v[2]});
    if (n < 6) return {};  // a fourth number is a weight of curves
    if (!has_colours_) {
      has_colours_ = true;
      colours_.reserve(position_lines_);
      colours_.assign(positions_.size() - 1, Rgba8{255, 255, 255, 255});
    }
    colours_.resize(positions_.size() - 1, Rgba8{255, 255, 255, 255});
    colours_.push_back({colour_byte(v[3] * 255), colour_byte(v[4] * 255), colour_byte(v[5] * 255),
                        n == 7 ? colour_byte(v[6] * 255) : std::uint8_t{255}});
    return {};
  }
  Result<void> read_normal(TextCursor& line) {
    std::array<double, 3> v{};
    if (numbers(line, v) < 3) return job_.corrupt_line(line.at, "expected three components after \"vn\"");
    normals_.push_back(vec_cast<float>(normalized(Vec3d{v[0], v[1], v[2]})));
    return {};
  }
  Result<void> read_texcoord(TextCursor& line) {
    std::array<double, 2> v{};
    if (numbers(line, v) < 1) return job_.corrupt_line(line.at, "expected coordinates after \"vt\"");
    texcoords_.push_back({static_cast<float>(v[0]), static_cast<float>(v[1])});
    return {};
  }

  struct Corner {
    std::uint64_t v, vt, vn;
  };

  Vertex vertex(const Corner& c) const {
    Vertex out;
    out.position = positions_[c.v];
    if (c.vn != none) out.normal = normals_[c.vn];
    if (c.v < colours_.size()) out.colour = colours_[c.v];
    if (c.vt != none) out.texcoord = texcoords_[c.vt];
    return out;
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
    const auto resolve = [&in_range](std::int64_t written, std::uint64_t seen, std::size_t size) {
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
    auto found = corner_map_.find_or_add({corner.v, corner.vt, corner.vn}, job_.budget);
    if (!found) return fail(std::move(found).error());
    if (found->is_new) {
      if (corner_positions_.size() == corner_positions_.capacity()) CUESTA_TRY(grow_corner_positions());
      corner_positions_.push_back(static_cast<std::uint32_t>(corner.v));
      CUESTA_TRY(out.vertex(vertex(corner)));
      out.set_vertex_count(corner_positions_.size());
    }
    return found->index;
  }
  Result<void> grow_corner_positions() {
    const std::size_t old = corner_positions_.capacity();
    CUESTA_TRY(job_.budget.charge(2 * old + 1024, sizeof(std::uint32_t), "vertices of faces"));
    corner_positions_.reserve(2 * old + 1024);
    job_.budget.release(old * sizeof(std::uint32_t));
    return {};
  }

  const ReadJob& job_;
  std::uint64_t position_lines_ = 0, normal_lines_ = 0, texcoord_lines_ = 0, face_lines_ = 0;
  std::uint64_t seen_positions_ = 0, seen_normals_ = 0, seen_texcoords_ = 0;
  bool has_colours_ = false;
  std::vector<Vec3d> positions_;
  std::vector<Rgba8> colours_;  ///< shorter than positions_ when the last ones have none
  std::vector<Vec3f> normals_;
  std::vector<TexCoord> texcoords_;
  std::vector<Corner> corners_;
  std::vector<std::uint64_t> indices_;
  CornerMap corner_map_;
  std::vector<std::uint32_t> corner_positions_;  ///< v of each distinct vertex, for polygons
};

}  // namespace

Result<ReadReport> read_obj(const ReadJob& job) {
  return ObjReader(job).read();
}

}  // namespace cuesta
