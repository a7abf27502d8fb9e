#include "apps/terrain_view/terrain_look.h"

#include <fmt/format.h>

#include <cmath>
#include <numbers>
#include <vector>

#include "runtime/view_fit.h"

namespace cuesta::terrain_view {
namespace {

constexpr double radians_per_degree = std::numbers::pi / 180;
constexpr double first_elevation_rad = 38 * radians_per_degree;
constexpr double globe_latitude_deg = 20;        // from which a globe is first seen
constexpr double wide_deg = 120, tall_deg = 90;  // bounds of these sizes are most of a globe

Relief globe(Vec3d centre, std::array<Vec3d, 3> axes) {
  const double a = wgs84_ellipsoid.equatorial_radius_m;
  return {.origin = centre,
          .axes = axes,
          .equatorial_radius = a,
          .polar_radius = a * (1 - 1 / wgs84_ellipsoid.inverse_flattening)};
}

/// The globe as a local frame has it.
Relief globe_around(Geodetic at) {
  const double lat = at.lat_deg * radians_per_degree, lon = at.lon_deg * radians_per_degree;
  const Vec3d east{-std::sin(lon), std::cos(lon), 0};
  const Vec3d up{std::cos(lat) * std::cos(lon), std::cos(lat) * std::sin(lon), std::sin(lat)};
  const Vec3d north = cross(up, east);
  const Vec3d origin = Frame::ecef().position_m(at);
  return globe(-Vec3d{dot(east, origin), dot(north, origin), dot(up, origin)},
               {Vec3d{east.x, north.x, up.x}, Vec3d{east.y, north.y, up.y}, Vec3d{east.z, north.z, up.z}});
}

bool is_globe(const TerrainFacts& f) {
  if (!f.bounds || f.frame.kind() == FrameKind::projected) return false;
  return f.bounds->east_deg - f.bounds->west_deg >= wide_deg ||
         f.bounds->north_deg - f.bounds->south_deg >= tall_deg;
}

}  // namespace

Relief relief_of(const Frame& frame) {
  switch (frame.kind()) {
    case FrameKind::ecef:
      return globe({}, {Vec3d{1, 0, 0}, Vec3d{0, 1, 0}, Vec3d{0, 0, 1}});
    case FrameKind::enu:
      return globe_around(frame.origin());
    case FrameKind::projected:
      break;
  }
  return {};
}

Result<std::optional<TerrainLook>> terrain_look(const Directory& directory,
                                                const std::filesystem::path& path) {
  auto facts = terrain_facts(directory.metadata);
  if (!facts) {
    Error error = facts.error();
    error.file = path.string();
    return fail(std::move(error));
  }
  if (!*facts) return std::optional<TerrainLook>();
  const Relief relief = relief_of((*facts)->frame);
  return std::optional<TerrainLook>(TerrainLook{std::move(**facts), relief, directory.has_colours});
}

void set_look(const TerrainLook& look, DrawOptions& options) {
  options.relief = look.relief;
  options.heights = {look.facts.least_m, look.facts.most_m, look.facts.sea_level_m, look.has_colours};
}

Vec3d middle_of(const TerrainLook& look, std::span<const Vec3d> points) {
  const double h_m = (look.facts.least_m + look.facts.most_m) / 2;
  if (look.facts.bounds) {
    const GeoBox& b = *look.facts.bounds;
    const Vec3d p = look.facts.frame.position_m(
        Geodetic{(b.south_deg + b.north_deg) / 2, (b.west_deg + b.east_deg) / 2, h_m});
    if (std::isfinite(length(p))) return p;
  }
  const Box3d box = box_of(points);
  return (box.lo + box.hi) * 0.5;
}

View first_view(const TerrainLook& look, std::span<const Vec3d> points, View view) {
  const Vec3d middle = middle_of(look, points);
  const Vec3d up = look.relief.up(middle), north = look.relief.north(middle);
  std::vector<Vec3d> drawn;
  for (const Vec3d& p : points) drawn.push_back(look.relief.raised(p));
  if (is_globe(look.facts)) {
    const double lat = globe_latitude_deg * radians_per_degree;
    const Vec3d pole = look.relief.axes[2], level = normalized(up - pole * dot(up, pole));
    view.up = pole;
    return fit_view(drawn, level * std::cos(lat) + pole * std::sin(lat), view);
  }
  view.up = up;
  return fit_view(drawn, up * std::sin(first_elevation_rad) - north * std::cos(first_elevation_rad), view);
}

std::string place_text(const TerrainLook& look, Vec3d p) {
  const Geodetic at = look.facts.frame.geodetic(p);
  if (!std::isfinite(at.lat_deg)) return fmt::format("x {:.1f} y {:.1f}, {:.1f} m", p.x, p.y, p.z);
  return fmt::format("{:.5f} {} {:.5f} {}, {:.1f} m", std::abs(at.lat_deg), at.lat_deg < 0 ? "S" : "N",
                     std::abs(at.lon_deg), at.lon_deg < 0 ? "W" : "E", at.h_m);
}

}  // namespace cuesta::terrain_view
