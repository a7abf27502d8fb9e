/// Wavefront OBJ: v (with colours), vn, vt, f. Two passes over the mapped text, vertex data and faces, as
/// faces may name later vertices. Vertex data are kept in tables that spill to a temporary file.

#include "ooc/obj_data.h"

namespace cuesta {
namespace {

constexpr std::uint64_t progress_lines = std::uint64_t{1} << 16;

class ObjReader {
 public:
  explicit ObjReader(const ReadJob& job) : job_(job), data_(job) {}

  Result<ReadReport> read() {
    CUESTA_TRY(read_vertex_data());
    const bool is_plain = data_.normals.empty() && data_.texcoords.empty();
    MeshEmitter out(job_, {.normals = !data_.normals.empty(),
                           .colours = !data_.colours.empty(),
                           .texcoords = !data_.texcoords.empty()});
    ObjFaces faces(job_, data_, out, is_plain ? ObjFaces::Vertices::positions : ObjFaces::Vertices::corners);
    if (is_plain) {
      if (job_.expect) CUESTA_TRY(job_.expect(data_.positions.size(), face_lines_));
      CUESTA_TRY(faces.emit_positions());
    }
    CUESTA_TRY(read_faces(faces, out));
    return out.finish();
  }

 private:
  std::uint64_t byte(const char* at) const { return static_cast<std::uint64_t>(at - job_.bytes.data()); }

  Result<void> read_vertex_data() {
    ObjStatements statements(job_.bytes);
    TextCursor line;
    for (std::uint64_t n = 1; statements.next(line); ++n) {
      const ObjKeyword word = obj_keyword(line);
      CUESTA_TRY(data_.add(word, line));
      face_lines_ += word == ObjKeyword::f;
      job_.passed(statements.at());
      if (n % progress_lines == 0) CUESTA_TRY(job_.report_progress(byte(statements.at()) / 2));
    }
    return {};
  }

  Result<void> read_faces(ObjFaces& faces, MeshEmitter& out) {
    ObjStatements statements(job_.bytes);
    TextCursor line;
    ObjSeen seen;
    for (std::uint64_t n = 1; statements.next(line); ++n) {
      const ObjKeyword word = obj_keyword(line);
      seen.count(word);
      if (word == ObjKeyword::f) CUESTA_TRY(faces.face(line, seen));
      const std::uint64_t done = (job_.bytes.size() + byte(statements.at())) / 2;
      out.at_byte(done);
      job_.passed(statements.at());
      if (n % progress_lines == 0) CUESTA_TRY(job_.report_progress(done));
    }
    return {};
  }

  const ReadJob& job_;
  ObjData data_;
  std::uint64_t face_lines_ = 0;
};

}  // namespace

Result<ReadReport> read_obj(const ReadJob& job) {
  return ObjReader(job).read();
}

}  // namespace cuesta
