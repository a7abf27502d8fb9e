#pragma once
/// A camera: where, which way, how wide, how many pixels.

#include <array>

#include "ooc/vec.h"

namespace cuesta {

/// World frame and units are the data's. Right-handed; at the identity orientation the camera looks along -z,
/// +y is up.
struct View {
  Vec3d eye;
  Vec3d target{0, 0, -1};                 ///< any point on the line of sight, != eye
  Vec3d up{0, 1, 0};                      ///< not parallel to the line of sight
  double fov_y_rad = 1.0471975511965976;  ///< full vertical angle, 0 < fov < π
  int width_px = 1280;
  int height_px = 720;

  /// Pixels that one unit of length covers at distance one along the line of sight: sse = error · k /
  /// distance.
  double pixels_per_unit() const;
  /// Orthonormal frame: right, up, back (the camera looks along -back).
  std::array<Vec3d, 3> frame() const;
};

}  // namespace cuesta
