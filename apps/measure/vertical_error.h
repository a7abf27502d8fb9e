#pragma once
/// How far above or below its postings a surface lies: the judge of terrain, independent of what simplifies
/// it. Frame and units: world metres, f64. Parallel in the calling TBB arena; same bits for any number of
/// threads.

#include <cstdint>
#include <functional>
#include <limits>
#include <span>

#include "ooc/surface_mesh.h"

namespace cuesta::measure {

/// Unit vector that points up at a world position; called from many threads.
using UpAt = std::function<Vec3d(Vec3d position_m)>;

struct VerticalOptions {
  /// Empty: (0, 0, 1) everywhere, a map's plane. Else that of a frame on the globe (terrain/frame.h), whose
  /// postings and corners are within `most_height_m` of the ellipsoid.
  UpAt up = {};
  double bound_m =
      std::numeric_limits<double>::infinity();  ///< postings farther from the surface are counted
  /// How far the surface may have been moved horizontally, as by snapping to a grid: that uncovers postings
  /// at the rim, and puts others under the next triangle, which may be steep. 0: not at all.
  double slack_m = 0;
  /// How far the rim of the surface may have moved: postings that are uncovered are looked for beside it. 0:
  /// not at all.
  double rim_m = 0;
};

inline constexpr double most_height_m = 12'000;

struct VerticalDeviation {
  std::uint64_t uncovered = 0;   ///< neither above nor below these postings is a triangle: a hole or a crack
  std::uint64_t beyond = 0;      ///< covered, but farther than bound_m
  double max_m = 0, p999_m = 0;  ///< of the covered; zeros if there are none
  std::uint64_t worst = 0;       ///< the first posting that attains max_m
};

struct VerticalError {
  std::uint64_t postings = 0;  ///< that are finite; the others are no data
  /// Along the up line through the posting itself. Where it meets several triangles the farthest counts, so
  /// folds do not hide errors.
  VerticalDeviation exact;
  /// Of postings that are uncovered or beyond: along the nearest line within slack_m on each triangle there,
  /// and of these the best counts. A crack as narrow as that is not found. Without slack the same as `exact`.
  VerticalDeviation with_slack;
  /// Of postings that are uncovered (exactly): the distance from the point of a triangle's outline that is
  /// nearest to the up line, and no farther from it than rim_m; of the triangles the one with the least
  /// distance counts. That is no less than the difference of heights there. Zeros if rim_m is 0.
  VerticalDeviation beside;
};

/// Watertight: a posting over an edge or a vertex between triangles is over one of them at least, as both
/// sides of an edge decide by the same bits. Triangles that are vertical cover nothing but what is within
/// slack_m.
/// @pre  is_consistent(mesh), all its corners finite; fewer than 2^32 postings.
/// @cost 10^7 postings under 5·10^6 triangles: 7 s of processor time, 20 bytes per posting; frames on the
/// globe take 24 more
///       per posting and vertex, and a call of `up` each.
VerticalError vertical_error(const SurfaceMesh& mesh, std::span<const Vec3d> postings_m,
                             const VerticalOptions& options = {});

}  // namespace cuesta::measure
