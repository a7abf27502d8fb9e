#include <algorithm>
#include <cmath>
#include <cstddef>
#include <span>
#include <utility>

#include "ooc/check.h"
#include "ooc/choose_grid.h"
#include "ooc/edge_twins.h"
#include "ooc/face_filter.h"
#include "ooc/grid_mesh.h"
#include "ooc/manifold_split.h"
#include "ooc/triangle_order.h"
#include "ooc/vertex_normals.h"
#include "ooc/weld.h"

namespace cuesta {
namespace {

bool is_finite(Vec3d p) {
  return std::isfinite(p.x) && std::isfinite(p.y) && std::isfinite(p.z);
}

/// Drops the faces at non-finite vertices.
/// @return per vertex whether a face that is left uses it.
std::vector<std::uint8_t> drop_nonfinite(SurfaceMesh& mesh, CleanReport& report) {
  for (const Vec3d& p : mesh.positions) report.nonfinite_vertices += !is_finite(p);
  if (report.nonfinite_vertices > 0)
    report.faces_nonfinite = std::erase_if(mesh.triangles, [&](const Triangle& t) {
      return !is_finite(mesh.positions[t[0]]) || !is_finite(mesh.positions[t[1]]) ||
             !is_finite(mesh.positions[t[2]]);
    });
  std::vector<std::uint8_t> used(mesh.positions.size(), 0);
  for (const Triangle& t : mesh.triangles)
    for (const std::uint32_t v : t) used[v] = 1;
  return used;
}

/// Snaps and welds; mesh.triangles then index welded vertices.
Welded weld_vertices(SurfaceMesh& mesh, const Grid& grid, std::span<const std::uint8_t> used,
                     CleanReport& report) {
  Welded welded = weld(mesh, grid, used);
  std::uint64_t users = 0;
  for (const std::uint8_t u : used) users += u;
  report.vertices_welded = users - welded.source.size();
  report.vertices_unused = mesh.positions.size() - report.nonfinite_vertices - users;
  for (Triangle& t : mesh.triangles) t = {welded.of[t[0]], welded.of[t[1]], welded.of[t[2]]};
  welded.of = {};
  return welded;
}

/// Makes the faces an oriented manifold; sources of the result are input vertices.
SplitVertices make_manifold(std::vector<Triangle>& triangles, const Welded& welded, CleanReport& report) {
  const FacesDropped dropped = drop_impossible_faces(triangles, welded.group);
  report.faces_degenerate = dropped.degenerate;
  report.faces_duplicate = dropped.duplicate;
  const auto twins = edge_twins(triangles, welded.group, report.edges_nonmanifold);
  SplitVertices split = split_fans(triangles, welded.group, twins);
  report.vertices_unused += welded.source.size() - split.used_before;
  report.vertices_split = split.source.size() - split.used_before;
  for (std::uint32_t& s : split.source) s = welded.source[s];
  return split;
}

template <class T>
std::vector<T> gather(const std::vector<T>& values, std::span<const std::uint32_t> source) {
  std::vector<T> out;
  if (values.empty()) return out;
  out.reserve(source.size());
  for (const std::uint32_t s : source) out.push_back(values[s]);
  return out;
}

std::uint64_t count_seam_groups(std::span<const std::uint32_t> group) {
  std::uint64_t count = 0;
  for (std::size_t v = 1; v < group.size(); ++v) count += group[v] == v - 1;
  return count;
}

bool is_zero(const Vec3f& n) {
  return n.x == 0 && n.y == 0 && n.z == 0;
}

bool needs_normals(const std::vector<Vec3f>& normals) {
  return normals.empty() || std::any_of(normals.begin(), normals.end(), is_zero);
}

void fill_normals(std::vector<Vec3f>& normals, std::vector<Vec3f> smooth) {
  if (normals.empty()) {
    normals = std::move(smooth);
    return;
  }
  for (std::size_t v = 0; v < normals.size(); ++v)
    if (is_zero(normals[v])) normals[v] = smooth[v];
}

/// @param mesh  the input, with triangles that index `vertices`
GridMesh assemble(SurfaceMesh mesh, const Grid& grid, SplitVertices vertices, const CleanOptions& options) {
  GridMesh out;
  out.grid = grid;
  sort_by_lowest_vertex(mesh.triangles, vertices.source.size());
  out.triangles = std::move(mesh.triangles);
  out.normals = gather(mesh.normals, vertices.source);
  out.colours = gather(mesh.colours, vertices.source);
  out.texcoords = gather(mesh.texcoords, vertices.source);
  const std::vector<Vec3d> positions = gather(mesh.positions, vertices.source);
  mesh = {};
  out.positions.reserve(positions.size());
  for (const Vec3d& p : positions) out.positions.push_back(grid.snap(p));
  // From the positions before snapping: at 64 steps to an edge, snapped ones tilt a face by up to a degree.
  if (options.make_normals && needs_normals(out.normals))
    fill_normals(out.normals, smooth_normals(positions, vertices.group, out.triangles));
  out.wedge_group = std::move(vertices.group);
  return out;
}

}  // namespace

Result<GridMesh> clean_mesh(SurfaceMesh mesh, const CleanOptions& options, CleanReport& report) {
  CUESTA_CHECK(is_consistent(mesh), mesh.positions.size(), mesh.triangles.size());
  report = {};
  if (mesh.triangles.size() > kMaxTriangles || mesh.positions.size() >= kNone)
    return fail(ErrorCode::invalid_input, "", "",
                "more triangles than one mesh in memory can have; split it");
  const std::vector<std::uint8_t> used = drop_nonfinite(mesh, report);
  const Result<Grid> grid = choose_grid(mesh.positions, mesh.triangles, options.step);
  if (!grid) return fail(grid.error());
  const Welded welded = weld_vertices(mesh, *grid, used, report);
  SplitVertices vertices = make_manifold(mesh.triangles, welded, report);
  if (mesh.triangles.empty())
    return fail(ErrorCode::invalid_input, "", "", "no triangle is left after cleaning");
  report.wedge_groups = count_seam_groups(vertices.group);
  return assemble(std::move(mesh), *grid, std::move(vertices), options);
}

}  // namespace cuesta
