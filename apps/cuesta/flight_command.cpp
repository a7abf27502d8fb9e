#include "apps/cuesta/flight_command.h"

#include <fmt/format.h>

#include <algorithm>

#include "apps/cuesta/open_cut.h"
#include "runtime/flight_file.h"
#include "runtime/view_fit.h"

namespace cuesta::app {
namespace {

/// The point that is nearest to someone who looks at the model's centre from `direction`.
Vec3d surface_point(std::span<const Vec3d> points, Vec3d direction) {
  constexpr double aside_counts = 3;  // so that it is in front of the centre, not at the rim
  const Box3d box = box_of(points);
  const Vec3d centre = (box.lo + box.hi) * 0.5;
  const auto score = [&](const Vec3d& p) {
    const double ahead = dot(p - centre, direction);
    return ahead - aside_counts * length(p - centre - direction * ahead);
  };
  return *std::max_element(points.begin(), points.end(),
                           [&](const Vec3d& a, const Vec3d& b) { return score(a) < score(b); });
}

}  // namespace

Result<void> run_flight(const FlightSettings& s) {
  auto cut = open_cut(s.file, 0);
  if (!cut) return fail(cut.error());
  const auto points = sketch_points(**cut);
  const Vec3d surface = surface_point(points, three_quarter_direction(s.view.up));
  const Flight flight = make_flight(s.kind, {points, surface}, s.view, s.frames, s.fps);
  if (auto r = write_flight(s.output, flight); !r) return r;
  fmt::print("{}: {} keyframes, {} frames at {:g} fps\n", s.output.string(), flight.keyframes.size(),
             s.frames, s.fps);
  return {};
}

}  // namespace cuesta::app
