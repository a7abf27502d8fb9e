#include "apps/tiles/tile_placement.h"

#include <cmath>

namespace cuesta::tiles {

TilePlacement::TilePlacement(const Directory& d, const std::optional<TerrainFacts>& facts) : grid_(d.grid) {
  const Vec3d middle = (d.grid.world(d.lo) + d.grid.world(d.hi)) * 0.5;
  if (facts) frame_ = facts->frame;
  const Geodetic at = facts ? frame_.geodetic(middle) : Geodetic{};
  on_earth_ = facts && std::isfinite(at.lat_deg) && std::isfinite(at.lon_deg);
  if (on_earth_ && frame_.kind() == FrameKind::projected) {
    auto local = Frame::enu({at.lat_deg, at.lon_deg, 0});
    if (local) bent_ = std::move(*local);
  }
  if (bent_) {
    put_axes(*bent_);
    return;
  }
  if (on_earth_) put_axes(frame_);
  zero_ = grid_.origin - middle;
  const Vec3d place = on_earth_ ? Frame::ecef().position_m(at) : middle;
  transform_[12] = place.x;
  transform_[13] = place.y;
  transform_[14] = place.z;
}

/// Of a local frame or of the globe.
void TilePlacement::put_axes(const Frame& local) {
  const Vec3d zero = local.of_ecef_m({});
  const Vec3d ecef_axes[3] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
  for (std::size_t row = 0; row < 3; ++row) {
    const Vec3d axis = local.of_ecef_m(ecef_axes[row]) - zero;
    for (std::size_t column = 0; column < 3; ++column)
      transform_[4 * column + row] = axis[static_cast<int>(column)];
  }
  const Vec3d origin = Frame::ecef().position_m(local.geodetic({}));
  transform_[12] = origin.x;
  transform_[13] = origin.y;
  transform_[14] = origin.z;
}

Vec3i TilePlacement::lattice(Vec3i grid_position) const {
  if (!bent_) return grid_position;
  const Vec3d p = bent_->position_m(frame_.geodetic(grid_.world(grid_position))) / grid_.step;
  return {static_cast<std::int32_t>(std::lround(p.x)), static_cast<std::int32_t>(std::lround(p.y)),
          static_cast<std::int32_t>(std::lround(p.z))};
}

}  // namespace cuesta::tiles
