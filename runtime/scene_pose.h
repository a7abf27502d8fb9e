#pragma once
/// Where the instances of a scene are now: at rest as the file has them, moved by its clips or by the caller.
/// Threads: one.

#include <cstdint>
#include <span>
#include <vector>

#include "ooc/scene.h"

namespace cuesta {

class ScenePose {
 public:
  /// At rest.   @param scene  outlives the pose
  explicit ScenePose(const Scene& scene);

  /// Puts a node somewhere in its parent; all below it move along. Takes effect with update().
  /// @pre node < nodes of the scene; the map is finite
  void set_local(std::uint32_t node, const LocalTransform& local);
  /// Moves a node by a vector of the world, as things are since the last update().
  /// @pre node < nodes of the scene   @post where a parent flattens space, it stays
  void move(std::uint32_t node, Vec3d by);
  /// Puts the nodes that the clip moves to where they are at that time.   @pre clip < clips of the scene
  void set_clip_time(std::uint32_t clip, double seconds);
  /// Recomputes what moved and all below it.
  /// @return the nodes whose world transform is another now, in rising order; until the next call.
  /// @cost O(nodes) where something moved, else O(1)
  std::span<const std::uint32_t> update();

  const Affine& world(std::uint32_t node) const { return world_[node]; }

 private:
  const Scene& scene_;
  std::vector<LocalTransform> local_;
  std::vector<Affine> world_;
  std::vector<std::uint8_t> moved_;  // since the last update(); during it, also what hangs on what moved
  bool any_moved_ = false;
  std::vector<std::uint32_t> changed_;
};

}  // namespace cuesta
