/// OFF and its prefixes: ST (texture coordinates), C (colours), N (normals). Comments run from # to the
/// line's end. What follows a vertex's or a face's own values on its line is passed over: writers put
/// undeclared colours there.

#include <fmt/format.h>

#include <algorithm>
#include <functional>

#include "ooc/mesh_emitter.h"
#include "ooc/spilled_table.h"
#include "ooc/text_cursor.h"

namespace cuesta {
namespace {

class OffReader {
 public:
  explicit OffReader(const ReadJob& job)
      : job_(job),
        text_{job.bytes.data(), job.bytes.data() + job.bytes.size()},
        positions_(job, "vertex positions") {}

  Result<ReadReport> read() {
    CUESTA_TRY(header());
    MeshEmitter out(job_, attributes_);
    out.set_vertex_count(vertex_count_);
    if (job_.expect) CUESTA_TRY(job_.expect(vertex_count_, face_count_));
    positions_.keep_free(job_.budget.left() / 2);
    for (std::uint64_t i = 0; i < vertex_count_; ++i) CUESTA_TRY(vertex(out));
    CUESTA_TRY(out.flush_vertices());
    out.set_positions([this](std::size_t, std::uint64_t vertex) { return positions_.get(vertex); });
    for (std::uint64_t i = 0; i < face_count_; ++i) CUESTA_TRY(face(out));
    return out.finish();
  }

 private:
  void skip_to_value() {
    text_.skip_spaces();
    while (!text_.done() && *text_.at == '#') {
      text_.skip_line();
      text_.skip_spaces();
    }
  }
  bool line_is_over() {
    text_.skip_blanks();
    return text_.done() || *text_.at == '\n' || *text_.at == '#';
  }
  std::uint64_t byte() const { return static_cast<std::uint64_t>(text_.at - job_.bytes.data()); }

  Result<double> real(const char* what) {
    skip_to_value();
    const std::optional<double> value = text_.real();
    if (!value || !text_.at_word_end()) return job_.corrupt_line(text_.at, fmt::format("expected {}", what));
    return *value;
  }
  Result<std::uint64_t> count(const char* what) {
    skip_to_value();
    const std::optional<std::int64_t> value = text_.integer();
    if (!value || *value < 0 || !text_.at_word_end()) {
      return job_.corrupt_line(text_.at, fmt::format("expected {}", what));
    }
    return static_cast<std::uint64_t>(*value);
  }

  Result<void> header() {
    skip_to_value();
    const TextCursor start = text_;
    std::string_view word = text_.word();
    if (const std::size_t keyword = word.find("OFF"); keyword != word.npos) {
      text_.at = start.at + keyword + 3;  // a count may follow without a blank
      word = word.substr(0, keyword);
      attributes_.texcoords = take(word, "ST");
      attributes_.colours = take(word, "C");
      attributes_.normals = take(word, "N");
      if (!word.empty()) {
        return job_.error(
            ErrorCode::unsupported_version, "line 1",
            fmt::format("OFF with {} (other than three dimensions) is not read", quote_word(word)));
      }
    } else {
      text_ = start;  // the keyword is optional
    }
    skip_to_value();
    if (const TextCursor here = text_; text_.word() == "BINARY") {
      return job_.error(ErrorCode::unsupported_version, "line 1",
                        "binary OFF is not read; convert it to PLY");
    } else {
      text_ = here;
    }
    auto vertices = count("the number of vertices");
    if (!vertices) return fail(std::move(vertices).error());
    auto faces = count("the number of faces");
    if (!faces) return fail(std::move(faces).error());
    if (!line_is_over()) {
      auto edges = text_.integer();  // rarely right and never needed
      if (!edges) return job_.corrupt_line(text_.at, "expected the number of edges");
    }
    text_.skip_line();
    vertex_count_ = *vertices;
    face_count_ = *faces;
    const std::uint64_t left = job_.bytes.size() - byte();
    constexpr std::uint64_t least_vertex = 6;  // "0 0 0\n"
    constexpr std::uint64_t least_face = 2;    // "0\n"
    if (vertex_count_ > (left + 1) / least_vertex || face_count_ > (left + 1) / least_face) {
      return job_.corrupt_line(text_.at,
                               fmt::format("{} vertices and {} faces do not fit in the {} bytes that follow",
                                           vertex_count_, face_count_, left));
    }
    return {};
  }

  static bool take(std::string_view& word, std::string_view prefix) {
    if (!word.starts_with(prefix)) return false;
    word.remove_prefix(prefix.size());
    return true;
  }

  Result<void> vertex(MeshEmitter& out) {
    Vertex v;
    for (int axis = 0; axis < 3; ++axis) {
      auto value = real("a coordinate of a vertex");
      if (!value) return fail(std::move(value).error());
      v.position[axis] = *value;
    }
    CUESTA_TRY(positions_.append(v.position));
    for (int axis = 0; attributes_.normals && axis < 3; ++axis) {
      auto value = real("a component of a normal");
      if (!value) return fail(std::move(value).error());
      v.normal[axis] = static_cast<float>(*value);
    }
    v.normal = normalized(v.normal);
    if (attributes_.colours || attributes_.texcoords) CUESTA_TRY(rest_of_vertex(v));
    text_.skip_line();
    out.at_byte(byte());
    job_.passed(text_.at);
    return out.vertex(v);
  }

  /// Colour, then texture coordinates, to the end of the line: a colour has three components or four.
  Result<void> rest_of_vertex(Vertex& v) {
    std::array<double, 6> values{};
    std::size_t n = 0;
    std::array<bool, 6> written_real{};
    while (n < values.size() && !line_is_over()) {
      const char* first = text_.at;
      auto value = real("a number");
      if (!value) return fail(std::move(value).error());
      written_real[n] = std::string_view(first, text_.at).find('.') != std::string_view::npos;
      values[n++] = *value;
    }
    std::size_t colour_components = n;
    if (attributes_.texcoords) {
      if (n < 2) return job_.corrupt_line(text_.at, "expected texture coordinates after the vertex");
      colour_components = attributes_.colours ? n - 2 : 0;
      v.texcoord = {static_cast<float>(values[colour_components]),
                    static_cast<float>(values[colour_components + 1])};
    }
    if (attributes_.colours) {
      const bool whole =
          std::none_of(written_real.begin(), written_real.begin() + colour_components, std::identity{});
      if (colour_components < 3)
        return job_.corrupt_line(text_.at, "expected a colour of three or four numbers");
      for (std::size_t k = 0; k < std::min<std::size_t>(4, colour_components); ++k) {
        v.colour[k] = colour_byte(whole ? values[k] : values[k] * 255);
      }
    }
    return {};
  }

  Result<void> face(MeshEmitter& out) {
    auto corners = count("the number of corners of a face");
    if (!corners) return fail(std::move(corners).error());
    const std::uint64_t left = job_.bytes.size() - byte();
    if (*corners > left / 2)
      return job_.corrupt_line(text_.at, fmt::format("a face of {} corners in {} bytes", *corners, left));
    CUESTA_TRY(out.expect_corners(*corners));
    corners_.clear();
    for (std::uint64_t k = 0; k < *corners; ++k) {
      skip_to_value();
      const std::optional<std::int64_t> index = text_.integer();
      if (!index) return job_.corrupt_line(text_.at, "expected the index of a corner");
      corners_.push_back(static_cast<std::uint64_t>(*index));  // a negative one becomes out of range
    }
    text_.skip_line();
    out.at_byte(byte());
    job_.passed(text_.at);
    return out.face(corners_);
  }

  const ReadJob& job_;
  TextCursor text_;
  AttributeSet attributes_;
  std::uint64_t vertex_count_ = 0;
  std::uint64_t face_count_ = 0;
  SpilledTable<Vec3d> positions_;
  std::vector<std::uint64_t> corners_;
};

}  // namespace

Result<ReadReport> read_off(const ReadJob& job) {
  return OffReader(job).read();
}

}  // namespace cuesta
