#include "runtime/draw/camera_matrices.h"

#include <cmath>

#include "ooc/check.h"

namespace cuesta {
namespace {

/// Half a grid step: no two positions are nearer to each other, and depth is still a normal float at 2^32
/// steps.
constexpr float near_plane_units = 0.5f;

std::int32_t whole_part(double coordinate) {
  constexpr double limit = (1 << 30) - 1;
  return static_cast<std::int32_t>(std::clamp(std::floor(coordinate), -limit, limit));
}

}  // namespace

CameraMatrices camera_matrices(const View& view, const Grid& grid) {
  CUESTA_CHECK(view.width_px > 0 && view.height_px > 0, view.width_px, view.height_px);
  CUESTA_CHECK(view.fov_y_rad > 0 && view.fov_y_rad < 3.1415926535897931, view.fov_y_rad);
  CUESTA_CHECK(grid.step > 0, grid.step);
  CameraMatrices camera;
  const Vec3d eye = (view.eye - grid.origin) / grid.step;
  camera.eye_whole = {whole_part(eye.x), whole_part(eye.y), whole_part(eye.z)};
  camera.eye_part = vec_cast<float>(eye - vec_cast<double>(camera.eye_whole));
  const auto frame = view.frame();
  for (std::size_t row = 0; row < 3; ++row)
    for (int column = 0; column < 3; ++column)
      camera.rotation[3 * row + static_cast<std::size_t>(column)] = static_cast<float>(frame[row][column]);
  const double focal = 1 / std::tan(view.fov_y_rad / 2);
  camera.focal = {static_cast<float>(focal * view.height_px / view.width_px), static_cast<float>(focal)};
  camera.near_units = near_plane_units;
  return camera;
}

}  // namespace cuesta
