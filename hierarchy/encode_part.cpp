#include "hierarchy/encode_part.h"

#include "hierarchy/build_tom.h"
#include "hierarchy/tom_codec.h"
#include "ooc/clean_part.h"

namespace cuesta {
namespace {

/// Vertices of the first segment, about: what a part costs until it is looked at.
constexpr Resolution first_vertices = 128;
constexpr std::uint32_t segment_ratio = 4;

ScenePartEntry entry_of(const Tom& tom) {
  ScenePartEntry entry;
  entry.vertices = tom.full();
  entry.triangles = tom.triangles.size();
  entry.attributes = {!tom.normals.empty(), !tom.colours.empty(), !tom.texcoords.empty()};
  entry.box.add(tom.origin + vec_cast<double>(tom.bounds.lo));
  entry.box.add(tom.origin + vec_cast<double>(tom.bounds.hi));
  return entry;
}

void encode_segments(const Tom& tom, EncodedPart& part) {
  Resolution from = 0;
  for (const Resolution to : segment_resolutions(tom, first_vertices, segment_ratio)) {
    part.segments.push_back(encode_tom_segment(tom, from, to));
    const BlockRef block{0, part.segments.back().size(), 0};
    part.entry.segments.push_back({block, to, triangle_count(tom, to), error_at(tom, to)});
    from = to;
  }
}

}  // namespace

Result<EncodedPart> encode_part(SurfaceMesh mesh, double step, bool make_normals) {
  auto clean = clean_part(std::move(mesh), step, make_normals);
  if (!clean) return fail(clean.error());
  EncodedPart part;
  part.clean = clean->report;
  if (clean->mesh.triangles.empty()) return part;
  TomOptions options;
  options.step = clean->grid.step;
  TomReport report;
  auto tom = build_tom(clean->mesh, options, &report);
  if (!tom) return fail(tom.error());
  part.clean.vertices_welded += report.welded_vertices;
  if (tom->triangles.empty()) return part;
  tom->snap_error += static_cast<float>(clean->snap_error);
  snap_attributes(*tom);
  part.entry = entry_of(*tom);
  encode_segments(*tom, part);
  return part;
}

}  // namespace cuesta
