#pragma once
/// What a viewer could see of a simplification: how many pixels each original vertex is away from the drawn
/// surface. Units: meshes and camera share one frame and unit; results in pixels. Parallel in the calling TBB
/// arena; same bits for any number of threads.

#include <cstdint>
#include <span>

#include "apps/measure/percentiles.h"
#include "apps/measure/triangle_tree.h"
#include "runtime/view.h"

namespace cuesta::measure {

enum class Region : std::uint8_t {
  in_frustum,  ///< only vertices that project into the picture (there is no near or far plane, and no
               ///< occlusion)
  everywhere,
};

/// Error of a vertex = view.pixels_per_unit() · distance(vertex, simplified surface) / distance(eye, vertex).
/// A vertex at the eye has error 0 if it is on the surface, else infinity.
struct ScreenError {
  Percentiles px;           ///< .count is the number of vertices in the region; zeros if none
  std::uint32_t worst = 0;  ///< original vertex that attains px.max
};

/// True if `p` is in front of the eye and projects into the picture, its edges included.
bool in_frustum(const View& view, Vec3d p);

/// @param simplified  infinite errors if it is empty.
/// @cost one nearest-point query per vertex in the region.
ScreenError screen_error(std::span<const Vec3d> original, const TriangleTree& simplified, const View& view,
                         Region region = Region::in_frustum);

/// The same from distances that are known (point_distances); for many cameras on one simplified mesh.
/// @pre distances.size() == original.size(); vertices with NaN do not count.
ScreenError screen_error(std::span<const Vec3d> original, std::span<const double> distances, const View& view,
                         Region region = Region::in_frustum);

}  // namespace cuesta::measure
