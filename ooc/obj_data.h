#pragma once
/// The text of a Wavefront OBJ file: statements, vertex data, and faces that name them. What whole files
/// (obj_reader.cpp) and scenes (obj_scene.cpp) have in common.

#include <array>
#include <cstdint>
#include <optional>
#include <string_view>
#include <vector>

#include "ooc/corner_map.h"
#include "ooc/mesh_emitter.h"
#include "ooc/spilled_table.h"
#include "ooc/text_cursor.h"

namespace cuesta {

/// One statement: the cursor spans the line, with the lines that a backslash joins to it.
class ObjStatements {
 public:
  explicit ObjStatements(std::span<const char> bytes)
      : at_(bytes.data()), end_(bytes.data() + bytes.size()) {}

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
inline void skip_obj_gap(TextCursor& line) {
  while (!line.done() && (TextCursor::is_space(*line.at) || *line.at == '\\')) ++line.at;
}

enum class ObjKeyword : std::uint8_t { other, v, vn, vt, f, o, g, usemtl, mtllib };

/// The statement's first word; the cursor is behind it then.
ObjKeyword obj_keyword(TextCursor& line);
/// What is left of the statement, without blanks around it.
std::string_view obj_rest(TextCursor line);
/// Up to N numbers; what is no number (a comment, for example) ends them. @return how many
template <std::size_t N>
std::size_t obj_numbers(TextCursor& line, std::array<double, N>& values);

/// How much was defined above a line: negative numbers in faces count back from there.
struct ObjSeen {
  std::uint64_t positions = 0, texcoords = 0, normals = 0;

  void count(ObjKeyword word) {
    positions += word == ObjKeyword::v;
    texcoords += word == ObjKeyword::vt;
    normals += word == ObjKeyword::vn;
  }
};

/// All vertex data of a file, in tables that spill to a temporary file. A third of the job's memory.
class ObjData {
 public:
  explicit ObjData(const ReadJob& job);

  /// Takes a line of v, vn or vt. @error corrupt with the line
  Result<void> add(ObjKeyword word, TextCursor line);

  SpilledTable<Vec3d> positions;
  SpilledTable<Rgba8> colours;  ///< shorter than positions when the last ones have none
  SpilledTable<Vec3f> normals;
  SpilledTable<TexCoord> texcoords;

 private:
  Result<void> add_position(TextCursor line);
  Result<void> add_normal(TextCursor line);
  Result<void> add_texcoord(TextCursor line);
  const ReadJob& job_;
};

/// Faces into an emitter. A vertex is a distinct corner of a face; or, of a file without vn and vt that is
/// read whole, its v, used or not.
class ObjFaces {
 public:
  enum class Vertices : std::uint8_t { corners, positions };

  /// @param vertices  positions: emit_positions() comes before the first face
  ObjFaces(const ReadJob& job, ObjData& data, MeshEmitter& out, Vertices vertices);

  Result<void> emit_positions();
  /// Corners from here on have this colour; those with different ones are different vertices, and texture
  /// coordinates are left out. @pre corners are vertices
  void set_colour(std::uint32_t number, Rgba8 colour) { colour_.emplace(Colour{number, colour}); }
  /// @param line  behind its "f"
  Result<void> face(TextCursor line, const ObjSeen& seen);

 private:
  static constexpr std::uint64_t none = ~std::uint64_t{0};  ///< the corner does not name one
  struct Corner {
    std::uint64_t v, vt, vn;
  };
  struct Colour {
    std::uint32_t number;
    Rgba8 value;
  };
  Result<void> read_corner(TextCursor& line, const ObjSeen& seen, Corner& corner, bool& in_range);
  Result<std::uint64_t> distinct_vertex(Corner corner);
  Result<void> emit(const Corner& corner);

  const ReadJob& job_;
  ObjData& data_;
  MeshEmitter& out_;
  Vertices vertices_;
  std::optional<Colour> colour_;
  std::uint64_t distinct_vertices_ = 0;
  std::vector<Corner> corners_;
  std::vector<std::uint64_t> indices_;
  CornerMap corner_map_;
};

template <std::size_t N>
std::size_t obj_numbers(TextCursor& line, std::array<double, N>& values) {
  std::size_t n = 0;
  while (n < N) {
    skip_obj_gap(line);
    const std::optional<double> value = line.real();
    if (!value) break;
    values[n++] = *value;
  }
  return n;
}

}  // namespace cuesta
