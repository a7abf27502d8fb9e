#pragma once
/// The clean surface that a build starts from: positions on the file's grid, an oriented manifold with
/// borders.

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "ooc/grid.h"
#include "ooc/result.h"
#include "ooc/surface_mesh.h"

namespace cuesta {

/// Invariants: every vertex is used by a triangle; the vertices of one wedge group (one position, different
/// attributes) are consecutive; taken group by group the surface is an oriented manifold with borders: each
/// edge has one or two triangles that run along it in opposite directions, the triangles around a group form
/// one fan or half-fan, no triangle uses a group twice, no two triangles use the same three groups. Vertices
/// are sorted along a space-filling curve, triangles by their lowest vertex.
struct GridMesh {
  Grid grid;
  std::vector<Vec3i> positions;
  std::vector<Vec3f> normals;  ///< empty or one per vertex, as the other attributes
  std::vector<Rgba8> colours;
  std::vector<TexCoord> texcoords;
  std::vector<std::uint32_t> wedge_group;  ///< index of the first vertex of its group
  std::vector<std::array<std::uint32_t, 3>> triangles;
};

/// What was dropped or changed on the way, by cause.
struct CleanReport {
  std::uint64_t nonfinite_vertices = 0;  ///< NaN or infinite position; their faces are dropped
  std::uint64_t faces_nonfinite = 0;
  std::uint64_t vertices_welded = 0;    ///< same grid position and same attributes as another vertex
  std::uint64_t faces_degenerate = 0;   ///< two corners at one position after welding
  std::uint64_t faces_duplicate = 0;    ///< the same three positions as an earlier face, either way round
  std::uint64_t edges_nonmanifold = 0;  ///< cut: more than two faces, or two faces in the same direction
  std::uint64_t vertices_split = 0;     ///< copies made to separate sheets
  std::uint64_t vertices_unused = 0;
  std::uint64_t wedge_groups = 0;  ///< positions with more than one vertex: attribute seams
};

struct CleanOptions {
  /// Grid step in world units; 0 chooses 1/128 of the median edge, less if some edges are short, and at least
  /// 2^-21 of the largest extent.
  double step = 0;
  /// Compute smooth (area-weighted) normals where the mesh has none: not at all, or zero at a vertex.
  bool make_normals = true;
};

/// Cleans, welds, snaps and orders `mesh` (consumed).
/// @error invalid_input when nothing is left, or when the extent does not fit the grid's range with the step
/// asked for.
/// @cost O(n log n) time, about 120 bytes per triangle beyond the input.
Result<GridMesh> clean_mesh(SurfaceMesh mesh, const CleanOptions& options, CleanReport& report);

}  // namespace cuesta
