#pragma once
/// The plain struct that crosses the border between mesh files and everything else: one indexed surface in
/// memory.

#include <array>
#include <cstdint>
#include <vector>

#include "ooc/vec.h"

namespace cuesta {

using Rgba8 = std::array<std::uint8_t, 4>;  ///< sRGB colour, straight alpha
using TexCoord = std::array<float, 2>;      ///< u right, v up

/// Which attributes the vertices of a surface have.
struct AttributeSet {
  bool normals = false;
  bool colours = false;
  bool texcoords = false;

  friend bool operator==(const AttributeSet&, const AttributeSet&) = default;
};

/// World frame and units are the file's own; counter-clockwise is outside.
/// Attribute arrays are empty or have one element per vertex. A corner with different attributes is another
/// vertex at the same position (a wedge).
struct SurfaceMesh {
  std::vector<Vec3d> positions;
  std::vector<Vec3f> normals;  ///< unit, or zero where the file had none
  std::vector<Rgba8> colours;
  std::vector<TexCoord> texcoords;
  std::vector<std::array<std::uint32_t, 3>> triangles;  ///< indices into positions
};

/// True if every attribute array is empty or as long as positions, and every index is in range.
bool is_consistent(const SurfaceMesh& mesh);

}  // namespace cuesta
