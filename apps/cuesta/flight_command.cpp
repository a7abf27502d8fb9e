#include "apps/cuesta/flight_command.h"

#include <fmt/format.h>

#include <algorithm>

#include "apps/cuesta/open_cut.h"
#include "apps/cuesta/terrain_settings.h"
#include "apps/overview/sketch.h"
#include "apps/sample/point_list.h"
#include "apps/scene_show/scene_player.h"
#include "apps/terrain_view/ground_flight.h"
#include "ooc/container_file.h"
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

Result<Flight> flight_over_ground(const FlightSettings& s, const terrain_view::TerrainLook& look) {
  const auto pairs = sample::pairs_of_words(s.route);
  if (!pairs) return fail(pairs.error());
  terrain_view::GroundRoute route{{}, s.above_ground_m};
  for (const sample::NumberPair pair : *pairs) {
    const auto place = sample::place_of(pair);
    if (!place) return fail(place.error());
    route.places.push_back(*place);
  }
  auto terrain = sample::HeightSampler::open(s.file);
  if (!terrain) return fail(terrain.error());
  return terrain_view::ground_flight(**terrain, look, route, s.view, s.frames, s.fps);
}

Result<Flight> flight_around(const FlightSettings& s, Cut& cut,
                             const std::optional<terrain_view::TerrainLook>& look) {
  auto points = sketch_points(cut);
  const View view = orbit_view(points, s.view, s.up_given, look);
  if (look)
    for (Vec3d& p : points) p = look->relief.raised(p);
  const Vec3d surface = surface_point(points, three_quarter_direction(view.up));
  return make_flight(s.kind, {points, surface}, view, s.frames, s.fps);
}

Result<void> check_words(const FlightSettings& s, bool over_ground) {
  if (over_ground || (s.route.empty() && !(s.above_ground_m > 0))) return {};
  return fail(ErrorCode::invalid_input, s.file.string(), "--route, --height",
              "are for --kind fly-over of terrain, without --up");
}

Result<Flight> surface_flight(const FlightSettings& s) {
  auto cut = open_cut(s.file, 0);
  if (!cut) return fail(cut.error());
  const auto look = look_of((*cut)->directory(), s.file, {}, s.exaggeration);
  if (!look) return fail(look.error());
  const bool over_ground = *look && s.kind == FlightKind::fly_over && !s.up_given;
  if (auto r = check_words(s, over_ground); !r) return fail(r.error());
  return over_ground ? flight_over_ground(s, **look) : flight_around(s, **cut, *look);
}

Result<Flight> scene_flight(const FlightSettings& s) {
  if (auto r = check_words(s, false); !r) return fail(r.error());
  const auto player = scene_show::ScenePlayer::open(s.file, {}, clock_ms);
  if (!player) return fail(player.error());
  const auto points = (*player)->sketch();
  const Vec3d surface = surface_point(points, three_quarter_direction(s.view.up));
  return make_flight(s.kind, {points, surface}, s.view, s.frames, s.fps);
}

}  // namespace

Result<void> run_flight(const FlightSettings& s) {
  const auto kind = ContainerReader::kind_of(s.file);
  if (!kind) return fail(kind.error());
  const auto flight = *kind == ContainerKind::scene ? scene_flight(s) : surface_flight(s);
  if (!flight) return fail(flight.error());
  if (auto r = write_flight(s.output, *flight); !r) return r;
  fmt::print("{}: {} keyframes, {} frames at {:g} fps\n", s.output.string(), flight->keyframes.size(),
             s.frames, s.fps);
  return {};
}

}  // namespace cuesta::app
