#pragma once
/// Materials of Wavefront OBJ files: .mtl.

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "ooc/result.h"
#include "ooc/scene.h"

namespace cuesta {

struct MaterialLibrary {
  std::vector<SceneMaterial> materials;  ///< in the order of the file; names are unique
  std::uint64_t textured = 0;            ///< of them have a map of the diffuse colour
};

/// Diffuse colour (Kd, taken as sRGB), opacity (d, Tr), Pm, Pr, and of those without Pr a roughness from Ns;
/// of two materials of one name the first. Statements that it does not know, or whose numbers are none, are
/// passed over.
/// @error not_found, io; out_of_budget: larger than 64 MiB
Result<MaterialLibrary> read_material_library(const std::filesystem::path& path);

}  // namespace cuesta
