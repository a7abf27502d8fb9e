#pragma once
/// Mesh files out: binary little-endian PLY, OBJ, GLB.

#include <filesystem>

#include "ooc/result.h"
#include "ooc/surface_mesh.h"

namespace cuesta {

/// Writes `mesh` in the format of the path's extension (.ply, .obj, .glb), with all its attributes, to a
/// temporary name beside `path` that is synced and then renamed: `path` is never half written. GLB positions
/// are f32 about the mesh's centre, with the centre in the node's translation.
/// @error invalid_input for another extension; io.
Result<void> write_mesh(const std::filesystem::path& path, const SurfaceMesh& mesh);

}  // namespace cuesta
