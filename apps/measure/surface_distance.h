#pragma once
/// How far one surface lies from another, by sampling: the judge of every simplification here.
/// Source: Cignoni, Rocchini, Scopigno, "Metro: measuring error on simplified surfaces", CGF 1998.
/// Deviations: samples are stratified along the accumulated area with a low-discrepancy sequence inside
/// triangles, and vertices count only for the maximum. Units: the meshes' own (percent_of() converts).
/// Parallel in the calling TBB arena; same bits for any number of threads. An empty `from` gives zeros with
/// no samples; an empty `to` gives infinity. Triangles that are not finite are ignored.

#include <cstdint>
#include <span>
#include <vector>

#include "apps/measure/percentiles.h"
#include "apps/measure/triangle_tree.h"
#include "ooc/surface_mesh.h"

namespace cuesta::measure {

struct SamplingOptions {
  std::uint64_t samples = 1'000'000;  ///< over the whole surface of one direction, shared by area
  std::uint64_t seed = 1;
};

/// From one surface to the other. The maximum is a lower bound of the one-sided Hausdorff distance.
struct DistanceStats {
  double mean = 0;            ///< over the area
  double rms = 0;             ///< over the area
  double max = 0;             ///< over area samples and vertices
  std::uint64_t samples = 0;  ///< area samples; vertices come on top
  Vec3d worst;                ///< the point of `from` that attains max
};

/// From the vertices of one mesh to the other's surface; each vertex counts once.
struct VertexDistances {
  std::vector<double>
      distances;  ///< one per vertex of `from`; NaN where no triangle uses it or it is not finite
  double mean = 0, rms = 0;
  Percentiles percentiles;  ///< of the vertices that count; .max is the largest, .count how many
  std::uint32_t worst = 0;  ///< vertex that attains the maximum
};

struct SymmetricDistance {
  DistanceStats forward, backward;  ///< a to b, b to a
  double mean = 0;                  ///< the mean of the two directions' means
  double rms = 0;                   ///< root of the mean of the two directions' squared rms
  double max = 0;                   ///< Hausdorff distance: the larger of the two maxima
};

TriangleTree make_tree(const SurfaceMesh& mesh);

/// Distance of each point to the surface: +infinity without a surface, NaN for points that are not finite.
/// @cost 0.3 to 1 µs per point and core, in any order of the points.
std::vector<double> point_distances(std::span<const Vec3d> points, const TriangleTree& to);

/// One-sided, over the area of `from`. @pre is_consistent(from).
DistanceStats surface_distance(const SurfaceMesh& from, const TriangleTree& to,
                               const SamplingOptions& options = {});

/// One-sided, over the vertices that `from`'s triangles use. @pre is_consistent(from).
VertexDistances vertex_distance(const SurfaceMesh& from, const TriangleTree& to);

SymmetricDistance symmetric_distance(const SurfaceMesh& a, const SurfaceMesh& b,
                                     const SamplingOptions& options = {});

/// Diagonal of the box around the vertices that the mesh's triangles use; 0 when there are none.
double bounding_diagonal(const SurfaceMesh& mesh);

/// The same with mean, rms and max in per cent of `diagonal` (of the original's, by custom). Zeros if
/// diagonal is 0.
DistanceStats percent_of(const DistanceStats& stats, double diagonal);
SymmetricDistance percent_of(const SymmetricDistance& distance, double diagonal);

}  // namespace cuesta::measure
