#pragma once
/// One part of a scene: from its mesh to the blocks of its TOM.

#include <cstddef>
#include <vector>

#include "hierarchy/scene_directory.h"
#include "ooc/clean_report.h"
#include "ooc/result.h"
#include "ooc/surface_mesh.h"

namespace cuesta {

struct EncodedPart {
  ScenePartEntry
      entry;  ///< without name; blocks have neither offset nor checksum. No triangles: nothing was left
  std::vector<std::vector<std::byte>> segments;
  CleanReport clean;
};

/// What build_tom() and all around it take for each triangle or three vertices, at most.
inline constexpr std::uint64_t encode_part_bytes_per_triangle = 700;

/// Cleans, simplifies and encodes. Pure.
/// @param step  grid step in units of the part; 0 chooses   @pre is_consistent(mesh)
/// @error invalid_input: the step is too small for the part
Result<EncodedPart> encode_part(SurfaceMesh mesh, double step, bool make_normals);

}  // namespace cuesta
