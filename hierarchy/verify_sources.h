#pragma once
/// Holds the source tables of coarser pages against what their sources really left over.

#include <cstdint>
#include <span>
#include <vector>

#include "hierarchy/verify_report.h"
#include "hierarchy/verify_script.h"

namespace cuesta {

/// A page's survivors while coarser pages claim them.
struct ClaimedSurvivors {
  ReplayedSurvivors survivors;
  std::vector<std::uint8_t> triangle_claims;  ///< how many coarser pages have it, at most 255
  std::vector<std::uint8_t> vertex_claims;
  std::vector<std::uint8_t> vertex_owners;  ///< how many of these remove it
  std::uint32_t pages_left = 0;             ///< coarser pages that have not been looked at
};

ClaimedSurvivors claimable(ReplayedSurvivors survivors, std::uint32_t coarser_pages);

/// Checks one source of a page and counts its claims: corners agree, and numbers are in range.
/// @param removed  per local vertex: a substitution of the page takes it (an orphan may be kept by another
/// page)
/// @param births  of the page's triangles; those of this source's run are set
void claim(PageId id, const Page& page, const PageSource& source, std::span<const std::uint8_t> removed,
           ClaimedSurvivors& from, std::vector<Birth>& births, VerifyReport& report);

/// When all coarser pages were looked at: every triangle claimed once, every vertex at least once, and one
/// that several pages share removed by none of them.
void check_claims(PageId source, const ClaimedSurvivors& claims, VerifyReport& report);

}  // namespace cuesta
