#pragma once
/// A flight along the ground of a terrain, from its finest data.

#include <vector>

#include "apps/sample/height_sampler.h"
#include "apps/terrain_view/terrain_look.h"
#include "runtime/flight.h"

namespace cuesta::terrain_view {

struct GroundRoute {
  /// At least two; none: along the longer side of the bounds, through their middle.
  std::vector<LatLon> places = {};
  double above_ground_m = 0;  ///< 0: a fiftieth of the route's length, at least 50 m
};

/// Eyes at that height above the highest ground around, so that they rise before a ridge and do not follow
/// each boulder; they look ahead and a little down. Where there is no data the ground is at height 0. Heights
/// are exaggerated as `look` says, the height above ground is not.
/// @param frames  ≥ 2, at `fps`.   @param view  its angle.
/// @error invalid_input: no route and no bounds, a route without length or beyond the frame; of reading
/// pages.
Result<Flight> ground_flight(sample::HeightSampler& terrain, const TerrainLook& look,
                             const GroundRoute& route, const View& view, std::uint64_t frames, double fps);

}  // namespace cuesta::terrain_view
