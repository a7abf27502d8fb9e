#pragma once
/// Where a terrain's vertices are: the frame that positions of latitude, longitude and height are put into.
///
/// All frames are in metres and right-handed. All computation is f64; within 100 km of the ground a position
/// comes back within 1e-6 m (1e-5 m in a frame in a projection far from its origin). Threads: const calls are
/// concurrent. Memory: about 200 bytes and the Crs.

#include <cstdint>
#include <optional>
#include <string>

#include "ooc/result.h"
#include "ooc/vec.h"
#include "ooc/vertical.h"
#include "terrain/crs.h"

namespace cuesta {

enum class FrameKind : std::uint8_t {
  ecef,  ///< the globe: x through (0° N, 0° E), y through (0° N, 90° E), z through the north pole; WGS 84
  enu,   ///< x east, y north, z up at an origin on or above the ellipsoid; the Earth curves away below z = 0
  projected,  ///< x east and y north of a projection in metres, also if its units are feet; z the height
};

class Frame {
 public:
  static Frame ecef();
  /// @error invalid_input: a latitude beyond a pole, or numbers that are not finite.
  static Result<Frame> enu(Geodetic origin);
  /// @error invalid_input: a geographic system, which is not a plane in metres.
  static Result<Frame> projected(Crs crs);

  /// Position of a place with ellipsoidal height h. NaN where the place is NaN or outside of the projection.
  /// A projected frame has z = h_m, whatever datum that height refers to; the others need ellipsoidal
  /// heights, so orthometric ones get the undulation of the geoid first (geoid.h).
  Vec3d position_m(Geodetic at) const;

  /// Position of a raster's posting: coordinates in its own system and units, height in metres as above.
  /// Exact (no detour over latitudes) where the frame is that same system.
  Vec3d position_m(const Crs& crs, PlanePoint p, double h_m) const;

  /// Position of a point given in ECEF. @pre kind() is not projected
  Vec3d of_ecef_m(Vec3d p_m) const;
  /// Which way is up, in metres.
  Vertical vertical_m() const;

  /// Unit vector that points up there: the normal of the ellipsoid, or z in a projected frame.
  Vec3d up(Vec3d position_m) const;

  /// Inverse of position_m(Geodetic). NaN outside of the projection.
  Geodetic geodetic(Vec3d position_m) const;

  FrameKind kind() const { return kind_; }
  /// Whether positions are this system's coordinates themselves, in metres.
  bool is_plane_of(const Crs& crs) const;
  /// Of a local frame; zeros for others.
  Geodetic origin() const { return origin_; }
  /// Of a projected frame; null for others.
  const Crs* crs() const { return crs_ ? &*crs_ : nullptr; }
  /// "ECEF, metres, WGS 84"
  std::string description() const;

 private:
  explicit Frame(FrameKind kind) : kind_(kind) {}
  Vec3d to_axes(Vec3d v) const { return {dot(east_, v), dot(north_, v), dot(up_, v)}; }
  Vec3d from_axes(Vec3d v) const { return east_ * v.x + north_ * v.y + up_ * v.z; }

  FrameKind kind_;
  Geodetic origin_;
  Vec3d origin_ecef_m_;
  Vec3d east_{1, 0, 0}, north_{0, 1, 0},
      up_{0, 0, 1};         // unit vectors in ECEF; only enu's differ from x, y, z
  std::optional<Crs> crs_;  // of a projected frame
};

}  // namespace cuesta
