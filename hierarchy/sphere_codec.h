#pragma once
/// Spheres of a page's fans, each as its difference from the one that follows from the page alone
/// (fan_cover.h). In round 0 there is none, and nothing is stored.

#include <span>
#include <vector>

#include "hierarchy/number_planes.h"
#include "hierarchy/page.h"

namespace cuesta {

inline constexpr std::size_t sphere_planes = 5;

/// @param places  of all local vertices
std::vector<Plane> pack_spheres(const Page& page, std::span<const Vec3i> places);

/// @pre page.round, wedge_tails, triangles and the script but for its spheres are there
/// @return false when the planes are damaged or the script explodes
[[nodiscard]] bool unpack_spheres(std::span<const Plane> planes, std::span<const Vec3i> places, Page& page);

}  // namespace cuesta
