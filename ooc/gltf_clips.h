#pragma once
/// Animations of a glTF document as clips of a scene.

#include <cstdint>
#include <span>

#include "ooc/gltf_document.h"
#include "ooc/scene.h"

namespace cuesta::gltf {

class Data;

struct ClipReport {
  std::uint64_t channels_dropped = 0;  ///< not of a node's transform, of a node with a matrix, without keys
  std::uint64_t keys_dropped = 0;      ///< their time does not come after that of the key before
};

/// @param node_of  per node of the document: its number in the scene, or no_index
/// @error of Data::numbers(); out_of_budget
Result<SceneClip> read_clip(const ReadJob& job, const Animation& animation, Data& data,
                            std::span<const std::uint32_t> node_of, const Scene& scene, ClipReport& report);

}  // namespace cuesta::gltf
