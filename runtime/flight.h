#pragma once
/// A camera's way through time: keyframes, interpolated smoothly; and generated ways around a model.

#include <cstdint>
#include <span>
#include <vector>

#include "runtime/view.h"

namespace cuesta {

struct Keyframe {
  double time_s = 0;
  Vec3d eye, target;
  Vec3d up{0, 1, 0};
  double fov_deg = 60;  ///< full vertical angle
};

/// @invariant at least one keyframe, times strictly ascending, all values finite, 0 < fov_deg < 180, eye !=
/// target,
///            1 ≤ fps.
struct Flight {
  double fps = 30;
  std::vector<Keyframe> keyframes;
};

/// Frames from the first keyframe to the last, both included.
std::uint64_t frame_count(const Flight& flight);
/// Seconds since the start of the flight.
double frame_time(const Flight& flight, std::uint64_t frame);

/// The camera at `time_s`, clamped to the keyframes. Eye and target on a Catmull–Rom spline through the
/// keyframes (non-uniform: tangents are of the two neighbours' difference over their time), up and angle
/// linear. Where a spline brings eye and target together, they are taken from the straight line between
/// keyframes.
/// @param size  the picture's size is taken from it.
View flight_view(const Flight& flight, double time_s, const View& size);

enum class FlightKind : std::uint8_t {
  orbit,         ///< once around at the height of a first picture
  zoom_in,       ///< from a first picture to 1 % of the diagonal before a point of the surface, steadily in
                 ///< octaves
  fly_over,      ///< from one end of the model to the other, close above it, looking ahead
  walk_through,  ///< around it, into its middle, a turn there in four jerks, and out: parts come into view
                 ///< abruptly
};

/// What a generated flight is about.
struct FlightSubject {
  std::span<const Vec3d> points;  ///< on it, coarse ones will do; not empty
  Vec3d surface;  ///< a point of the surface that can be seen from three_quarter_direction(); for zoom_in
};

/// @param view    fov and picture size that the model is fitted to; its up is the flight's.
/// @param frames  ≥ 2, at `fps`.
Flight make_flight(FlightKind kind, const FlightSubject& subject, const View& view, std::uint64_t frames,
                   double fps = 30);

}  // namespace cuesta
