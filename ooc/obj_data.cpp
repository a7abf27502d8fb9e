#include "ooc/obj_data.h"

namespace cuesta {
namespace {

template <class T>
Result<void> look_up(SpilledTable<T>& table, std::uint64_t i, T& value) {
  auto found = table.get(i);
  if (!found) return fail(std::move(found).error());
  value = *found;
  return {};
}

}  // namespace

ObjKeyword obj_keyword(TextCursor& line) {
  line.skip_blanks();
  const std::string_view word = line.word();
  if (word == "v") return ObjKeyword::v;
  if (word == "vn") return ObjKeyword::vn;
  if (word == "vt") return ObjKeyword::vt;
  if (word == "f") return ObjKeyword::f;
  if (word == "o") return ObjKeyword::o;
  if (word == "g") return ObjKeyword::g;
  if (word == "usemtl") return ObjKeyword::usemtl;
  if (word == "mtllib") return ObjKeyword::mtllib;
  return ObjKeyword::other;
}

std::string_view obj_rest(TextCursor line) {
  skip_obj_gap(line);
  std::string_view text(line.at, static_cast<std::size_t>(line.end - line.at));
  while (!text.empty() && TextCursor::is_space(text.back())) text.remove_suffix(1);
  return text;
}

ObjData::ObjData(const ReadJob& job)
    : positions(job, "vertex positions"),
      colours(job, "colours"),
      normals(job, "normals"),
      texcoords(job, "texture coordinates"),
      job_(job) {
  const std::uint64_t keep_free = job.budget.left() / 3 * 2;
  positions.keep_free(keep_free);
  colours.keep_free(keep_free);
  normals.keep_free(keep_free);
  texcoords.keep_free(keep_free);
}

Result<void> ObjData::add(ObjKeyword word, TextCursor line) {
  if (word == ObjKeyword::v) return add_position(line);
  if (word == ObjKeyword::vn) return add_normal(line);
  return word == ObjKeyword::vt ? add_texcoord(line) : Result<void>{};
}

Result<void> ObjData::add_position(TextCursor line) {
  std::array<double, 7> v{};
  const std::size_t n = obj_numbers(line, v);
  if (n < 3) return job_.corrupt_line(line.at, "expected three coordinates after \"v\"");
  CUESTA_TRY(positions.append({v[0], v[1], v[2]}));
  if (n < 6) return {};  // a fourth number is a weight of curves
  while (colours.size() + 1 < positions.size()) CUESTA_TRY(colours.append({255, 255, 255, 255}));
  return colours.append({colour_byte(v[3] * 255), colour_byte(v[4] * 255), colour_byte(v[5] * 255),
                         n == 7 ? colour_byte(v[6] * 255) : std::uint8_t{255}});
}

Result<void> ObjData::add_normal(TextCursor line) {
  std::array<double, 3> v{};
  if (obj_numbers(line, v) < 3) return job_.corrupt_line(line.at, "expected three components after \"vn\"");
  return normals.append(vec_cast<float>(normalized(Vec3d{v[0], v[1], v[2]})));
}

Result<void> ObjData::add_texcoord(TextCursor line) {
  std::array<double, 2> v{};
  if (obj_numbers(line, v) < 1) return job_.corrupt_line(line.at, "expected coordinates after \"vt\"");
  return texcoords.append({static_cast<float>(v[0]), static_cast<float>(v[1])});
}

ObjFaces::ObjFaces(const ReadJob& job, ObjData& data, MeshEmitter& out, Vertices vertices)
    : job_(job),
      data_(data),
      out_(out),
      vertices_(vertices),
      // An eighth for the caches of what was spilled and for polygons.
      corner_map_(job.budget, job.budget.left() / 8) {
  out_.set_positions(
      [this](std::size_t corner, std::uint64_t) { return data_.positions.get(corners_[corner].v); });
}

Result<void> ObjFaces::emit_positions() {
  for (std::uint64_t i = 0; i < data_.positions.size(); ++i) CUESTA_TRY(emit({i, none, none}));
  out_.set_vertex_count(data_.positions.size());
  return {};
}

Result<void> ObjFaces::emit(const Corner& c) {
  Vertex v;
  CUESTA_TRY(look_up(data_.positions, c.v, v.position));
  if (c.vn != none) CUESTA_TRY(look_up(data_.normals, c.vn, v.normal));
  if (colour_) v.colour = colour_->value;
  if (c.v < data_.colours.size()) CUESTA_TRY(look_up(data_.colours, c.v, v.colour));
  if (!colour_ && c.vt != none) CUESTA_TRY(look_up(data_.texcoords, c.vt, v.texcoord));
  return out_.vertex(v);
}

Result<void> ObjFaces::face(TextCursor line, const ObjSeen& seen) {
  corners_.clear();
  bool in_range = true;
  for (skip_obj_gap(line); !line.done() && *line.at != '#'; skip_obj_gap(line)) {
    CUESTA_TRY(out_.expect_corners(corners_.size() + 1));
    Corner corner{};
    CUESTA_TRY(read_corner(line, seen, corner, in_range));
    corners_.push_back(corner);
  }
  indices_.clear();
  for (const Corner& corner : corners_) {
    if (!in_range) {
      indices_.push_back(none);
    } else if (vertices_ == Vertices::positions) {
      indices_.push_back(corner.v);
    } else {
      auto index = distinct_vertex(corner);
      if (!index) return fail(std::move(index).error());
      indices_.push_back(*index);
    }
  }
  return out_.face(indices_);
}

/// v, v/vt, v//vn or v/vt/vn; negative numbers count back from the last one defined above this line.
Result<void> ObjFaces::read_corner(TextCursor& line, const ObjSeen& seen, Corner& corner, bool& in_range) {
  const auto resolve = [&in_range](std::int64_t written, std::uint64_t above, std::uint64_t size) {
    const std::uint64_t index =
        written > 0 ? static_cast<std::uint64_t>(written) - 1 : above + static_cast<std::uint64_t>(written);
    if (written == 0 || index >= size) in_range = false;
    return index;
  };
  const std::optional<std::int64_t> v = line.integer();
  if (!v) return job_.corrupt_line(line.at, "expected a corner such as 1, 1/2, 1//3 or 1/2/3");
  corner = {resolve(*v, seen.positions, data_.positions.size()), none, none};
  if (!line.done() && *line.at == '/') {
    ++line.at;
    if (const auto vt = line.integer()) corner.vt = resolve(*vt, seen.texcoords, data_.texcoords.size());
  }
  if (!line.done() && *line.at == '/') {
    ++line.at;
    if (const auto vn = line.integer()) corner.vn = resolve(*vn, seen.normals, data_.normals.size());
  }
  if (!line.at_word_end() && *line.at != '\\')
    return job_.corrupt_line(line.at, "expected a corner such as 1, 1/2, 1//3 or 1/2/3");
  return {};
}

Result<std::uint64_t> ObjFaces::distinct_vertex(Corner corner) {
  if (colour_) corner.vt = colour_->number;
  const auto found = corner_map_.find_or_add({corner.v, corner.vt, corner.vn}, distinct_vertices_);
  if (found.is_new) {
    CUESTA_TRY(emit(corner));
    out_.set_vertex_count(++distinct_vertices_);
  }
  return found.index;
}

}  // namespace cuesta
