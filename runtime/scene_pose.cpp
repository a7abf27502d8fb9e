#include "runtime/scene_pose.h"

#include <algorithm>

#include "ooc/check.h"

namespace cuesta {

ScenePose::ScenePose(const Scene& scene)
    : scene_(scene), world_(world_transforms(scene)), moved_(scene.nodes.size()) {
  local_.reserve(scene.nodes.size());
  for (const SceneNode& node : scene.nodes) local_.push_back(node.local);
}

void ScenePose::set_local(std::uint32_t node, const LocalTransform& local) {
  CUESTA_CHECK(node < local_.size(), node, local_.size());
  local_[node] = local;
  moved_[node] = 1;
  any_moved_ = true;
}

void ScenePose::move(std::uint32_t node, Vec3d by) {
  CUESTA_CHECK(node < local_.size(), node, local_.size());
  const std::uint32_t parent = scene_.nodes[node].parent;
  const Affine outer = parent == no_index ? Affine{} : world_[parent];
  if (determinant(outer) == 0) return;
  LocalTransform local = local_[node];
  std::visit([&](auto& l) { l.translation = l.translation + inverse(outer).vector(by); }, local);
  set_local(node, local);
}

void ScenePose::set_clip_time(std::uint32_t clip, double seconds) {
  CUESTA_CHECK(clip < scene_.clips.size(), clip, scene_.clips.size());
  apply_clip(scene_.clips[clip], seconds, local_);
  for (const SceneChannel& channel : scene_.clips[clip].channels) moved_[channel.node] = 1;
  any_moved_ = true;
}

std::span<const std::uint32_t> ScenePose::update() {
  changed_.clear();
  if (!any_moved_) return changed_;
  for (std::uint32_t i = 0; i < local_.size(); ++i) {
    const std::uint32_t parent = scene_.nodes[i].parent;
    if (parent != no_index && moved_[parent]) moved_[i] = 1;
    if (!moved_[i]) continue;
    const Affine own = affine_of(local_[i]);
    const Affine world = parent == no_index ? own : world_[parent] * own;
    moved_[i] = world == world_[i] ? 0 : 1;  // a clip may hold still
    if (!moved_[i]) continue;
    world_[i] = world;
    changed_.push_back(i);
  }
  std::fill(moved_.begin(), moved_.end(), std::uint8_t{0});
  any_moved_ = false;
  return changed_;
}

}  // namespace cuesta
