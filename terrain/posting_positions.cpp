#include "terrain/posting_positions.h"

#include <GeographicLib/Geocentric.hpp>
#include <cmath>
#include <vector>

namespace cuesta {
namespace {

/// The meridian's plane at a latitude: where the ellipsoid is, and up.
struct MeridianPoint {
  double from_axis_m, z_m, up_from_axis, up_z;
};

MeridianPoint meridian_point(double lat_deg) {
  std::vector<double> m(9);
  double y = 0;
  MeridianPoint p{};
  GeographicLib::Geocentric::WGS84().Forward(lat_deg, 0, 0, p.from_axis_m, y, p.z_m, m);
  p.up_from_axis = m[2];
  p.up_z = m[8];
  return p;
}

}  // namespace

PostingPositions::PostingPositions(const Frame& frame, const Crs& crs, const PostingMap& map)
    : frame_(frame), crs_(crs), map_(map), is_plane_(frame.is_plane_of(crs)) {
  is_globe_ = crs.geographic() && map.is_axis_aligned() && frame.kind() != FrameKind::projected;
  if (crs.geographic() && map.is_axis_aligned())
    columns_around_ = 360 / std::abs(map.x_per_column * crs.definition().unit);
}

void PostingPositions::of(std::int64_t first_column, std::int64_t first_row, std::uint64_t width,
                          std::uint64_t height, std::span<const float> heights_m,
                          std::span<Vec3d> positions_m) const {
  if (is_globe_) return of_globe(first_column, first_row, width, height, heights_m, positions_m);
  const double unit_m = crs_.definition().unit;
  for (std::uint64_t r = 0; r < height; ++r)
    for (std::uint64_t c = 0; c < width; ++c) {
      const std::size_t i = r * width + c;
      const double column = static_cast<double>(first_column + static_cast<std::int64_t>(c));
      const double row = static_cast<double>(first_row + static_cast<std::int64_t>(r));
      const PlanePoint p{map_.x(column, row), map_.y(column, row)};
      const double h = static_cast<double>(heights_m[i]);
      positions_m[i] = is_plane_ ? Vec3d{p.x * unit_m, p.y * unit_m, h} : frame_.position_m(crs_, p, h);
    }
}

void PostingPositions::of_globe(std::int64_t first_column, std::int64_t first_row, std::uint64_t width,
                                std::uint64_t height, std::span<const float> heights_m,
                                std::span<Vec3d> positions_m) const {
  std::vector<Vec3d> equator(width);  // cosine and sine of each longitude
  for (std::uint64_t c = 0; c < width; ++c) {
    const double column = static_cast<double>(first_column + static_cast<std::int64_t>(c));
    const double lon_deg = crs_.lat_lon({map_.x(column, 0), 0}).lon_deg;
    std::vector<double> m(9);
    Vec3d p;
    GeographicLib::Geocentric::WGS84().Forward(0, lon_deg, 0, p.x, p.y, p.z, m);
    equator[c] = {m[2], m[5], 0};
  }
  // All frames but projected ones are linear in ECEF: the column's part once, not once a posting.
  // Axes are taken where rounding is as small a share of them as of a position.
  constexpr double far_m = 0x1p24;
  const Vec3d origin = frame_.of_ecef_m({});
  const auto axis = [&](Vec3d unit) { return (frame_.of_ecef_m(unit * far_m) - origin) / far_m; };
  const Vec3d z_axis = axis({0, 0, 1});
  for (Vec3d& e : equator) e = axis(e);
  for (std::uint64_t r = 0; r < height; ++r) {
    const double row = static_cast<double>(first_row + static_cast<std::int64_t>(r));
    const MeridianPoint at = meridian_point(crs_.lat_lon({map_.x0, map_.y(0, row)}).lat_deg);
    for (std::uint64_t c = 0; c < width; ++c) {
      const std::size_t i = r * width + c;
      const double h = static_cast<double>(heights_m[i]);
      positions_m[i] =
          origin + equator[c] * (at.from_axis_m + h * at.up_from_axis) + z_axis * (at.z_m + h * at.up_z);
    }
  }
}

LatticePoint PostingPositions::lattice_point(Vec3d position_m, double near_column) const {
  const double unit = crs_.definition().unit;
  PlanePoint p;
  if (is_plane_) {
    p = {position_m.x / unit, position_m.y / unit};
  } else {
    p = crs_.coordinates(frame_.geodetic(position_m).lat_lon());
  }
  const double dx = p.x - map_.x0, dy = p.y - map_.y0;
  const double area = map_.x_per_column * map_.y_per_row - map_.x_per_row * map_.y_per_column;
  LatticePoint at{(dx * map_.y_per_row - dy * map_.x_per_row) / area,
                  (dy * map_.x_per_column - dx * map_.y_per_column) / area};
  if (columns_around_ > 0)
    at.column -= columns_around_ * std::floor((at.column - near_column) / columns_around_ + 0.5);
  return at;
}

}  // namespace cuesta
