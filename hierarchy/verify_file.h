#pragma once
/// Checks a .cuesta file from the file alone: bytes, directory, source tables, and the invariants that each
/// page's script must keep (I2 legal, I3 saturated), births carried from finer to coarser pages. What needs
/// cuts of the whole surface (I1, I5) is in apps/verify/.

#include <cstdint>
#include <functional>

#include "hierarchy/cuesta_file.h"
#include "hierarchy/verify_report.h"

namespace cuesta {

struct VerifyOptions {
  std::size_t max_findings = 20;
  /// For positions of coarser pages that are kept; a miss reads the page again.
  std::uint64_t position_bytes = std::uint64_t{256} << 20;
};

/// Pages done of the total; returning false cancels.
using VerifyProgress = std::function<bool(std::uint64_t done, std::uint64_t total)>;

/// Looks at every page once, finer before coarser, neighbours together. What is wrong is a finding, not an
/// error.
/// @error cancelled.
/// @cost about 3 µs per triangle; memory: position_bytes, one page, and the survivors that wait for a coarser
/// page
///       (32 bytes per triangle; a front of pages, not a whole round).
Result<VerifyReport> verify_file(const CuestaFile& file, const VerifyOptions& options = {},
                                 const VerifyProgress& progress = {});

}  // namespace cuesta
