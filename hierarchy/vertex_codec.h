#pragma once
/// Positions and attributes of a page's owned vertices, each as its difference from what its neighbours let
/// expect. All arithmetic is on integers, and the same everywhere.

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "hierarchy/number_planes.h"
#include "hierarchy/owned_mesh.h"

namespace cuesta {

inline constexpr std::size_t position_planes = 7, normal_planes = 3, colour_planes = 4, texcoord_planes = 3;

/// @param places  positions of all local vertices
std::vector<Plane> pack_positions(const OwnedMesh& mesh, std::span<const Vec3i> places);
std::vector<Plane> pack_normals(const OwnedMesh& mesh, std::span<const Vec3i> places, const Page& page);
std::vector<Plane> pack_colours(const OwnedMesh& mesh, const std::vector<Rgba8>& colours);
std::vector<Plane> pack_texcoords(const OwnedMesh& mesh,
                                  const std::vector<std::array<std::int32_t, 2>>& texcoords);

// The inverses fill one element per owned vertex and return false when the planes are damaged.
/// @param places  those of survivors are there
[[nodiscard]] bool unpack_positions(std::span<const Plane> planes, const OwnedMesh& mesh,
                                    std::span<Vec3i> places);
/// @pre page.triangles are there
[[nodiscard]] bool unpack_normals(std::span<const Plane> planes, const OwnedMesh& mesh,
                                  std::span<const Vec3i> places, Page& page);
[[nodiscard]] bool unpack_colours(std::span<const Plane> planes, const OwnedMesh& mesh,
                                  std::vector<Rgba8>& colours);
[[nodiscard]] bool unpack_texcoords(std::span<const Plane> planes, const OwnedMesh& mesh,
                                    std::vector<std::array<std::int32_t, 2>>& texcoords);

}  // namespace cuesta
