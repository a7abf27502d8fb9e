#include "apps/tiles/globe_borders.h"

#include <cmath>
#include <numbers>

namespace cuesta::tiles {
namespace {

struct Direction {
  double sine, cosine;
};

Direction direction(double degrees) {
  const double angle = degrees * std::numbers::pi / 180;
  return {std::sin(angle), std::cos(angle)};
}

PartBorder meridian(double degrees) {  // metres, ECEF; its inside is in the east
  const Direction d = direction(degrees);
  return {{}, {-d.sine, d.cosine, 0}};
}

PartBorder parallel(double degrees) {  // its inside is in the north
  const Direction d = direction(degrees);
  const double f = 1 / wgs84_ellipsoid.inverse_flattening, e_sq = f * (2 - f);
  const double normal_m = wgs84_ellipsoid.equatorial_radius_m / std::sqrt(1 - e_sq * d.sine * d.sine);
  return {{0, 0, -e_sq * normal_m * d.sine}, {0, 0, d.cosine}, -d.sine};
}

}  // namespace

PartBorder globe_border(const Frame& frame, const Grid& grid, Side side, double degrees) {
  PartBorder border = side == Side::west || side == Side::east ? meridian(degrees) : parallel(degrees);
  if (side == Side::east || side == Side::north) {
    border.inward = -border.inward;
    border.radial = -border.radial;
  }
  border.inward = frame.of_ecef_m(border.inward) - frame.of_ecef_m({});
  border.apex = (frame.of_ecef_m(border.apex) - grid.origin) / grid.step;
  return border;
}

}  // namespace cuesta::tiles
