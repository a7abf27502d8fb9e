#pragma once
/// Where the nodes of a glTF document put their meshes.

#include <array>
#include <vector>

#include "ooc/gltf_document.h"
#include "ooc/vec.h"

namespace cuesta::gltf {

/// An affine map: point = columns · p + translation. Normals go by its inverse transpose.
struct Transform {
  std::array<Vec3d, 3> columns{Vec3d{1, 0, 0}, Vec3d{0, 1, 0}, Vec3d{0, 0, 1}};
  Vec3d translation;
  bool mirrored = false;  ///< turns the winding round

  Vec3d point(Vec3d p) const { return columns[0] * p.x + columns[1] * p.y + columns[2] * p.z + translation; }
  Vec3f normal(Vec3d n) const;
};

/// `outer` after the node's local matrix.
Transform compose(const Transform& outer, const std::array<double, 16>& local);

/// For each mesh, the transforms of the nodes that show it, in depth-first order. Not recursive.
/// @error corrupt for a node that is reached twice: a cycle, or two parents; out_of_budget.
Result<std::vector<std::vector<Transform>>> instances_of(const ReadJob& job, const Document& document);

}  // namespace cuesta::gltf
