#pragma once
/// Replays a page's script on its mesh and holds every substitution to I2 (legal) and I3 (saturated).
/// Shares no code with the kernel that wrote the script: points, links and births are found anew.

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "hierarchy/page.h"
#include "hierarchy/verify_report.h"

namespace cuesta {

/// A triangle may turn by no more than this in one substitution (the kernel's limit is 0.2, in float).
inline constexpr double least_turn_cosine = 0.199;

/// What is left of a page's mesh. Vertices are numbered among the survivors, as source tables do.
struct ReplayedSurvivors {
  std::uint32_t vertices = 0;
  std::vector<std::array<std::uint32_t, 3>> triangles;  ///< lowest vertex first
  std::vector<Birth> births;                            ///< one per triangle
  std::uint32_t removed_triangles = 0;
};

/// @param positions  one per local vertex
/// @param vertical   of a field of heights: triangles may turn, but not over seen from above
/// @param births     one per triangle: of the fan that changed it last, in a finer page
/// @cost about 2 µs per substitution; 150 bytes per triangle.
ReplayedSurvivors verify_script(PageId id, const Page& page, std::span<const Vec3i> positions,
                                std::vector<Birth> births, const std::optional<Vertical>& vertical,
                                VerifyReport& report);

}  // namespace cuesta
