#pragma once
/// Which part is under the pointer.

#include <cstdint>
#include <optional>

#include "runtime/live_scene.h"

namespace cuesta::scene_show {

struct PartHit {
  std::uint32_t instance = 0;  ///< of LiveScene::instances()
  double distance = 0;         ///< in world units
};

/// The nearest triangle on a ray, of those that the scene's last frame drew, from either side.
/// @param direction  unit
/// @cost O(objects drawn + triangles drawn of those whose balls the ray meets before the nearest triangle)
std::optional<PartHit> part_along(const LiveScene& scene, Vec3d origin, Vec3d direction);

}  // namespace cuesta::scene_show
