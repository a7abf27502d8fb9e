/// Where postings of tiles are, against the closed formula of the ellipsoid in extended precision.

#include "terrain/posting_positions.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <vector>

namespace cuesta {
namespace {

struct Axes {
  long double x = 0, y = 0, z = 0;
};

constexpr long double degree = std::numbers::pi_v<long double> / 180;

/// Of WGS 84, from its defining a and 1/f.
Axes ecef_of(long double lat_deg, long double lon_deg, long double h_m) {
  const long double a = 6378137, f = 1 / 298.257223563L, e2 = f * (2 - f);
  const long double sin_lat = std::sin(lat_deg * degree), cos_lat = std::cos(lat_deg * degree);
  const long double n = a / std::sqrt(1 - e2 * sin_lat * sin_lat);
  return {(n + h_m) * cos_lat * std::cos(lon_deg * degree), (n + h_m) * cos_lat * std::sin(lon_deg * degree),
          (n * (1 - e2) + h_m) * sin_lat};
}

Axes enu_of(const Geodetic& origin, Axes p) {
  const Axes o = ecef_of(origin.lat_deg, origin.lon_deg, origin.h_m);
  const long double x = p.x - o.x, y = p.y - o.y, z = p.z - o.z;
  const long double sin_lat = std::sin(origin.lat_deg * degree), cos_lat = std::cos(origin.lat_deg * degree),
                    sin_lon = std::sin(origin.lon_deg * degree), cos_lon = std::cos(origin.lon_deg * degree);
  return {-sin_lon * x + cos_lon * y, -sin_lat * (cos_lon * x + sin_lon * y) + cos_lat * z,
          cos_lat * (cos_lon * x + sin_lon * y) + sin_lat * z};
}

long double apart_m(Vec3d p, Axes q) {
  return std::hypot(static_cast<long double>(p.x) - q.x, static_cast<long double>(p.y) - q.y,
                    static_cast<long double>(p.z) - q.z);
}

/// A tile of 1 degree in 1201² postings, by its south-western corner as .hgt files are named.
struct Tile {
  double south_deg, west_deg;
  static constexpr std::int64_t last = 1200;
  PostingMap map() const {
    PostingMap m;
    m.x0 = west_deg;
    m.y0 = south_deg + 1;
    m.x_per_column = 1.0 / last;
    m.y_per_row = -1.0 / last;
    m.x_per_row = m.y_per_column = 0;
    return m;
  }
};

const std::vector<Tile> tiles{{27, 86}, {-34, 18}, {0, -180}, {-1, 179}, {89, 0}, {-90, -45}, {46, 7}};

struct Posting {
  std::int64_t column, row;
  float h_m;
};
const std::vector<Posting> corners{{0, 0, 8848.86f},
                                   {Tile::last, 0, -430},
                                   {0, Tile::last, 0},
                                   {Tile::last, Tile::last, 4807.5f},
                                   {617, 255, 100}};

/// The largest distance of a tile's postings from where they are.
template <class Expected>
long double worst_of(const Tile& tile, const Frame& frame, Expected expected) {
  const PostingPositions positions(frame, Crs::from_epsg(4326).value(), tile.map());
  long double worst = 0;
  for (const auto& [column, row, h_m] : corners) {
    Vec3d found;
    positions.of(column, row, 1, 1, {&h_m, 1}, {&found, 1});
    const Axes at =
        ecef_of(tile.south_deg + 1 - static_cast<long double>(row) / Tile::last,
                tile.west_deg + static_cast<long double>(column) / Tile::last, static_cast<long double>(h_m));
    worst = std::max(worst, apart_m(found, expected(at)));
  }
  return worst;
}

TEST(PostingPositions, corners_of_tiles_on_the_globe) {
  for (const Tile& tile : tiles)
    EXPECT_LT(worst_of(tile, Frame::ecef(), [](Axes at) { return at; }), 1e-7L)
        << tile.south_deg << ", " << tile.west_deg;
}

TEST(PostingPositions, corners_of_tiles_in_local_frames) {
  for (const Tile& tile : tiles) {
    const Geodetic origin{tile.south_deg + 0.5, tile.west_deg + 0.25, 1234};
    EXPECT_LT(worst_of(tile, Frame::enu(origin).value(), [&](Axes at) { return enu_of(origin, at); }), 1e-7L)
        << tile.south_deg << ", " << tile.west_deg;
  }
}

/// A posting comes back to its column and row.
TEST(PostingPositions, lattice_points_are_the_inverse) {
  for (const Tile& tile : tiles)
    for (const Frame& frame : {Frame::ecef(), Frame::enu({tile.south_deg + 0.5, tile.west_deg, 0}).value()}) {
      const PostingPositions positions(frame, Crs::from_epsg(4326).value(), tile.map());
      EXPECT_EQ(positions.columns_around(), 360.0 * Tile::last);
      EXPECT_FALSE(positions.is_straight());
      for (const auto& [column, row, h_m] : corners) {
        Vec3d at;
        positions.of(column, row, 1, 1, {&h_m, 1}, {&at, 1});
        const LatticePoint p = positions.lattice_point(at, 600);
        EXPECT_NEAR(p.row, double(row), 1e-5);
        const double lat = tile.south_deg + 1 - double(row) / Tile::last;
        if (std::abs(lat) < 89.99) {
          EXPECT_NEAR(p.column, double(column), 1e-5);
        }
      }
    }
}

}  // namespace
}  // namespace cuesta
