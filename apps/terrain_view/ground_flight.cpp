#include "apps/terrain_view/ground_flight.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace cuesta::terrain_view {
namespace {

constexpr std::size_t stations = 257;         // along the route, where the ground is sampled
constexpr std::size_t stations_of_a_key = 4;  // from one keyframe to the next
constexpr std::size_t reach = 6;              // stations before and behind whose ground counts
constexpr double inset = 0.06;                // of the bounds, at both ends of a route of its own
constexpr double usual_height = 0.02, least_height_m = 50;
constexpr double look_down = 0.16;  // rise over run, towards the target

/// Points on straight lines between places, evenly by their length in the frame. (Between places far apart
/// the way goes below the globe: heights are set later.)
std::vector<Geodetic> along(const TerrainLook& look, const std::vector<Vec3d>& corners) {
  std::vector<double> way{0};
  for (std::size_t i = 1; i < corners.size(); ++i)
    way.push_back(way.back() + length(corners[i] - corners[i - 1]));
  std::vector<Geodetic> points;
  std::size_t leg = 0;
  for (std::size_t k = 0; k < stations; ++k) {
    const double at = way.back() * static_cast<double>(k) / (stations - 1);
    while (leg + 2 < corners.size() && way[leg + 1] < at) ++leg;
    const double size = way[leg + 1] - way[leg],
                 t = size > 0 ? std::clamp((at - way[leg]) / size, 0.0, 1.0) : 0;
    points.push_back(look.facts.frame.geodetic(corners[leg] + (corners[leg + 1] - corners[leg]) * t));
  }
  return points;
}

Result<std::vector<LatLon>> places_of(const GroundRoute& route, const TerrainFacts& facts) {
  if (!route.places.empty()) return route.places;
  if (!facts.bounds)
    return fail(ErrorCode::invalid_input, "", "", "the file does not know its bounds: give a --route");
  const GeoBox& b = *facts.bounds;
  const double lat = (b.south_deg + b.north_deg) / 2, lon = (b.west_deg + b.east_deg) / 2;
  const double wide = std::min(b.east_deg - b.west_deg, 120.0), tall = b.north_deg - b.south_deg;
  const double shrink = std::cos(lat * std::numbers::pi / 180);
  if (wide * shrink > tall) {
    const double half = wide * (0.5 - inset);
    return std::vector<LatLon>{{lat, lon - half}, {lat, lon}, {lat, lon + half}};
  }
  return std::vector<LatLon>{
      {b.south_deg + tall * inset, lon}, {lat, lon}, {b.north_deg - tall * inset, lon}};
}

Result<std::vector<Vec3d>> corners_of(const std::vector<LatLon>& places, const TerrainLook& look) {
  std::vector<Vec3d> corners;
  for (const LatLon& p : places) {
    corners.push_back(look.facts.frame.position_m(Geodetic{p.lat_deg, p.lon_deg, 0}));
    if (!std::isfinite(length(corners.back())))
      return fail(ErrorCode::invalid_input, "", "route",
                  "a place is outside of " + look.facts.frame.description());
  }
  double size = 0;
  for (std::size_t i = 1; i < corners.size(); ++i) size += length(corners[i] - corners[i - 1]);
  if (!(size > 0))
    return fail(ErrorCode::invalid_input, "", "route", "has no length: give two places or more");
  return corners;
}

/// Sets each point's height to the ground's.
Result<void> drop(sample::HeightSampler& terrain, std::vector<Geodetic>& points) {
  for (Geodetic& p : points) {
    const auto ground = terrain.at(p.lat_lon());
    if (!ground) return fail(ground.error());
    p.h_m = *ground ? (*ground)->at.h_m : 0;
  }
  return {};
}

double highest_around(const std::vector<Geodetic>& points, std::size_t k) {
  double most = points[k].h_m;
  for (std::size_t i = k > reach ? k - reach : 0; i <= std::min(k + reach, points.size() - 1); ++i)
    most = std::max(most, points[i].h_m);
  return most;
}

}  // namespace

Result<Flight> ground_flight(sample::HeightSampler& terrain, const TerrainLook& look,
                             const GroundRoute& route, const View& view, std::uint64_t frames, double fps) {
  const auto places = places_of(route, look.facts);
  if (!places) return fail(places.error());
  const auto corners = corners_of(*places, look);
  if (!corners) return fail(corners.error());
  std::vector<Geodetic> points = along(look, *corners);
  if (auto r = drop(terrain, points); !r) return fail(r.error());
  double size_m = 0;
  std::vector<Vec3d> ground;
  for (const Geodetic& p : points) {
    ground.push_back(look.facts.frame.position_m(Geodetic{p.lat_deg, p.lon_deg, 0}));
    if (ground.size() > 1) size_m += length(ground.back() - ground[ground.size() - 2]);
  }
  const double above_m =
      route.above_ground_m > 0 ? route.above_ground_m : std::max(least_height_m, usual_height * size_m);
  Flight flight;
  flight.fps = fps;
  const double seconds = static_cast<double>(frames - 1) / fps;
  for (std::size_t k = 0; k < stations; k += stations_of_a_key) {
    const Vec3d up = look.relief.up(ground[k]);
    const Vec3d on = ground[std::min(k + stations_of_a_key, stations - 1)],
                from = ground[k >= stations_of_a_key ? k - stations_of_a_key : 0];
    const Vec3d ahead = normalized((on - from) - up * dot(on - from, up));
    const double height_m = look.relief.exaggeration * highest_around(points, k) + above_m;
    const Vec3d eye = ground[k] + up * height_m;
    const double run_m = std::max(8 * above_m, 1.0);
    flight.keyframes.push_back({seconds * static_cast<double>(k) / (stations - 1), eye,
                                eye + ahead * run_m - up * (run_m * look_down), up,
                                view.fov_y_rad * 180 / std::numbers::pi});
  }
  return flight;
}

}  // namespace cuesta::terrain_view
