#pragma once
/// Where the nodes of a glTF document put their meshes.

#include <vector>

#include "ooc/affine.h"
#include "ooc/gltf_document.h"

namespace cuesta::gltf {

class Data;

/// Of EXT_mesh_gpu_instancing: where the node's mesh is shown, in the node's frame; once where it is,
/// without.
/// @error corrupt; of Data::numbers(); out_of_budget
Result<std::vector<Trs>> placements_of(const ReadJob& job, const Document& document,
                                       const Instancing& instancing, Data& data);

/// A node in the order in which a scene has them: its parent is visited before it.
struct Visit {
  Id node = none;
  std::uint32_t parent = no_index;  ///< place of its parent among the visits
};

/// All nodes that a root leads to, depth first, children in their order. Not recursive.
/// @error corrupt for a node that is reached twice: a cycle, or two parents; out_of_budget.
Result<std::vector<Visit>> visits_of(const ReadJob& job, const Document& document);

/// For each mesh, the transforms of the nodes that show it, in the order of visits.
/// @error of visits_of() and placements_of()
Result<std::vector<std::vector<Affine>>> instances_of(const ReadJob& job, const Document& document,
                                                      Data& data);

}  // namespace cuesta::gltf
