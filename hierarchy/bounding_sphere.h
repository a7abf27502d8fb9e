#pragma once
/// Small balls around balls, as stored.

#include <span>

#include "hierarchy/error_code.h"

namespace cuesta {

/// A code whose decoded sphere contains every ball of `inner` in the sense of contains(); near-minimal.
/// Source: Bădoiu, Clarkson, "Smaller core-sets for balls", SODA 2003, a fixed number of steps from the best
/// axis pair.
/// @param inner       at least one ball, grid units, absolute
/// @param fan_centre  what the stored offset is relative to
/// @cost  O(inner) · 10
SphereCode enclose(std::span<const Sphere> inner, Vec3i fan_centre);

}  // namespace cuesta
