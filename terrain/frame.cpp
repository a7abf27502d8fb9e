#include "terrain/frame.h"

#include <fmt/format.h>

#include <GeographicLib/Geocentric.hpp>
#include <cmath>
#include <limits>
#include <vector>

#include "ooc/check.h"

namespace cuesta {
namespace {

constexpr double nan = std::numeric_limits<double>::quiet_NaN();

struct LocalAxes {
  Vec3d position_m, east, north, up;
};

Vec3d column(const std::vector<double>& m, std::size_t i) {
  return {m[i], m[3 + i], m[6 + i]};
}

LocalAxes axes_at(Geodetic at) {
  LocalAxes axes;
  std::vector<double> m(9);
  GeographicLib::Geocentric::WGS84().Forward(at.lat_deg, at.lon_deg, at.h_m, axes.position_m.x,
                                             axes.position_m.y, axes.position_m.z, m);
  axes.east = column(m, 0);
  axes.north = column(m, 1);
  axes.up = column(m, 2);
  return axes;
}

Vec3d ecef_of(Geodetic at) {
  Vec3d p;
  GeographicLib::Geocentric::WGS84().Forward(at.lat_deg, at.lon_deg, at.h_m, p.x, p.y, p.z);
  return p;
}

Geodetic geodetic_of_ecef(Vec3d p) {
  Geodetic at;
  GeographicLib::Geocentric::WGS84().Reverse(p.x, p.y, p.z, at.lat_deg, at.lon_deg, at.h_m);
  return at;
}

bool is_place(Geodetic at) {
  return std::abs(at.lat_deg) <= 90 && std::isfinite(at.lon_deg) && std::isfinite(at.h_m);
}

}  // namespace

Frame Frame::ecef() {
  return Frame(FrameKind::ecef);
}

Result<Frame> Frame::enu(Geodetic origin) {
  if (!is_place(origin)) {
    return fail(ErrorCode::invalid_input, "", "origin of the local frame",
                fmt::format("expected a latitude within ±90 degrees and finite numbers, found {}, {}, {} m",
                            origin.lat_deg, origin.lon_deg, origin.h_m));
  }
  Frame frame(FrameKind::enu);
  const LocalAxes axes = axes_at(origin);
  frame.origin_ = origin;
  frame.origin_ecef_m_ = axes.position_m;
  frame.east_ = axes.east;
  frame.north_ = axes.north;
  frame.up_ = axes.up;
  return frame;
}

Result<Frame> Frame::projected(Crs crs) {
  if (crs.geographic()) {
    return fail(ErrorCode::invalid_input, "", crs.definition().name,
                "degrees are not a plane in metres; choose a projected system, a local frame or the globe");
  }
  Frame frame(FrameKind::projected);
  frame.crs_ = std::move(crs);
  return frame;
}

Vec3d Frame::position_m(Geodetic at) const {
  if (!is_place(at)) return {nan, nan, nan};
  if (kind_ == FrameKind::projected) {
    const PlanePoint p = crs_->coordinates(at.lat_lon());
    const double unit_m = crs_->definition().unit;
    return {p.x * unit_m, p.y * unit_m, at.h_m};
  }
  return to_axes(ecef_of(at) - origin_ecef_m_);
}

Vec3d Frame::position_m(const Crs& crs, PlanePoint p, double h_m) const {
  if (is_plane_of(crs)) {
    const double unit_m = crs.definition().unit;
    return {p.x * unit_m, p.y * unit_m, h_m};
  }
  const LatLon at = crs.lat_lon(p);
  return position_m(Geodetic{at.lat_deg, at.lon_deg, h_m});
}

bool Frame::is_plane_of(const Crs& crs) const {
  return crs_ && same_coordinates(crs.definition(), crs_->definition());
}

Vec3d Frame::of_ecef_m(Vec3d p_m) const {
  CUESTA_CHECK(kind_ != FrameKind::projected);
  return to_axes(p_m - origin_ecef_m_);
}

Vertical Frame::vertical_m() const {
  if (kind_ == FrameKind::projected) return {};
  const double shrink = 1 - GeographicLib::Geocentric::WGS84().Flattening();
  return {.axis = to_axes({0, 0, 1}),
          .is_plane = false,
          .centre = to_axes(-origin_ecef_m_),
          .stretch = 1 / (shrink * shrink) - 1};
}

Vec3d Frame::up(Vec3d position_m) const {
  if (kind_ == FrameKind::projected) return {0, 0, 1};
  return to_axes(axes_at(geodetic(position_m)).up);
}

Geodetic Frame::geodetic(Vec3d position_m) const {
  if (kind_ == FrameKind::projected) {
    const double unit_m = crs_->definition().unit;
    const LatLon at = crs_->lat_lon({position_m.x / unit_m, position_m.y / unit_m});
    return {at.lat_deg, at.lon_deg, position_m.z};
  }
  return geodetic_of_ecef(origin_ecef_m_ + from_axes(position_m));
}

std::string Frame::description() const {
  switch (kind_) {
    case FrameKind::ecef:
      return "ECEF, metres, WGS 84";
    case FrameKind::enu:
      return fmt::format("local east, north, up in metres, origin {} N, {} E, {} m", origin_.lat_deg,
                         origin_.lon_deg, origin_.h_m);
    case FrameKind::projected:
      return crs_->description() + ", in metres";
  }
  return "";
}

}  // namespace cuesta
