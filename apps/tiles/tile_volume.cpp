#include "apps/tiles/tile_volume.h"

#include <cmath>
#include <numbers>

namespace cuesta::tiles {
namespace {

constexpr double pi = std::numbers::pi;
constexpr double radians = pi / 180;
constexpr double least_radius_m = 6.33e6;  // of the Earth's curves, wherever: a degree is at least so long
constexpr int samples = 8;                 // along each side of a range that is bent

double within_turn(double angle) {
  return angle > pi ? angle - 2 * pi : angle < -pi ? angle + 2 * pi : angle;
}

/// How far the middle of a line between two points of the ground is below it.
double sag_m(double edge_m) {
  return edge_m * edge_m / (8 * least_radius_m);
}

TileVolume region(const TilePlacement& placement, const TileRange& range, const TileMesh& mesh,
                  double margin_m, double error_m) {
  double least = std::numeric_limits<double>::max(), most = std::numeric_limits<double>::lowest();
  for (const DrawVertex& v : mesh.vertices) {
    const double h = placement.geodetic({v.x, v.y, v.z}).h_m;
    least = std::min(least, h);
    most = std::max(most, h);
  }
  const double longest_m = longest_edge(mesh) * placement.step();
  const double pad_lat = (margin_m + sag_m(longest_m)) / least_radius_m;
  const double south = std::max(range.lo[1] * radians - pad_lat, -pi / 2);
  const double north = std::min(range.hi[1] * radians + pad_lat, pi / 2);
  const double narrow = std::max(std::cos(std::max(std::abs(south), std::abs(north))), 1e-6);
  const double pad_lon = pad_lat / narrow;
  double west = range.lo[0] * radians - pad_lon, east = range.hi[0] * radians + pad_lon;
  if (east - west >= 2 * pi) {
    west = -pi;
    east = pi;
  }
  const double pad_h = height_errors * error_m;
  return {
      true,
      {within_turn(west), south, within_turn(east), north, least - sag_m(longest_m) - pad_h, most + pad_h}};
}

/// In grid units: the range, and of a terrain the content's heights.
Box3d range_box(const TileTree& tree, const TileRange& range, const TileMesh& mesh, double margin,
                double error) {
  Box3d box;
  box.add(Vec3d{range.lo[0], range.lo[1], range.lo[2]});
  box.add(Vec3d{range.hi[0], range.hi[1], range.hi[2]});
  if (tree.axes() == 2) {
    Box3d content;
    for (const DrawVertex& v : mesh.vertices) content.add(vec_cast<double>(Vec3i{v.x, v.y, v.z}));
    box.lo.z = content.lo.z - height_errors * error;
    box.hi.z = content.hi.z + height_errors * error;
  }
  return {box.lo - Vec3d{margin, margin, margin}, box.hi + Vec3d{margin, margin, margin}};
}

/// Of a range whose sides are bent, by samples; what lies between two of them is within their sag.
Box3d bent_box(const TilePlacement& placement, const Box3d& box) {
  Box3d bent;
  const Vec3d size = box.hi - box.lo;
  for (int i = 0; i <= samples; ++i)
    for (int j = 0; j <= samples; ++j)
      for (const double z : {box.lo.z, box.hi.z}) {
        const Vec3d p{box.lo.x + size.x * i / samples, box.lo.y + size.y * j / samples, z};
        bent.add(placement.local({static_cast<std::int32_t>(std::lround(p.x)),
                                  static_cast<std::int32_t>(std::lround(p.y)),
                                  static_cast<std::int32_t>(std::lround(z))}));
      }
  const double pad = 2 * sag_m(length(size) * placement.step() / samples) + placement.step();
  return {bent.lo - Vec3d{pad, pad, pad}, bent.hi + Vec3d{pad, pad, pad}};
}

TileVolume box_volume(const Box3d& local) {
  const Vec3d centre = (local.lo + local.hi) * 0.5, half = (local.hi - local.lo) * 0.5;
  return {false, {centre.x, centre.y, centre.z, half.x, 0, 0, 0, half.y, 0, 0, 0, half.z}};
}

}  // namespace

TileVolume volume_of(const TileTree& tree, const TilePlacement& placement, const Grid& grid,
                     const TileRange& range, const TileMesh& mesh, double margin, double error) {
  if (tree.on_globe()) return region(placement, range, mesh, margin * grid.step, error);
  const Box3d box = range_box(tree, range, mesh, margin, error / grid.step);
  if (placement.bends()) return box_volume(bent_box(placement, box));
  const Vec3d zero = placement.lattice_zero();
  return box_volume({zero + box.lo * grid.step, zero + box.hi * grid.step});
}

}  // namespace cuesta::tiles
