#pragma once
/// The balls of a script's fans: around all that a fan covers, and around the balls of what it depends on
/// (I3). Of the original surface's triangles they follow from the mesh and the script alone, and are not
/// stored.

#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "hierarchy/cell_mesh.h"

namespace cuesta {

/// A mesh at the start of its round, and what is known of its triangles.
struct CoveredMesh {
  std::span<const Vec3i> positions;            ///< per vertex
  std::span<const std::uint32_t> first_wedge;  ///< per vertex: the first one of its wedge group
  std::span<const std::array<std::uint32_t, 3>> triangles;
  std::span<const Birth> births;  ///< per triangle; empty: all are of the original surface
};

/// Given the sphere that follows for a fan, the one that it has.
using FanSphere = std::function<SphereCode(std::size_t fan, SphereCode follows)>;

/// Sets the spheres of the script's fans. A fan covers the triangles around each vertex as it is substituted
/// and, where none of these is left, those around its target; after the first strict_fans also those around
/// the third corners of triangles that go.
/// @param changed  gets per triangle the fan that changed it last, or no_fan
/// @param sphere   if given, has the last word, fan by fan: where births of earlier rounds are not known
/// @return false if the script would carry triangles along so often that it must be an attack
/// @cost about 1 µs per substitution
[[nodiscard]] bool cover_fans(const CoveredMesh& mesh, Script& script, std::vector<std::uint32_t>& changed,
                              const FanSphere& sphere = {});
inline constexpr std::uint32_t no_fan = ~std::uint32_t{0};

}  // namespace cuesta
