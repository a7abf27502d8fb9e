#pragma once
/// What the directory says against what pages are.

#include <vector>

#include "hierarchy/directory.h"
#include "hierarchy/verify_report.h"
#include "hierarchy/verify_script.h"

namespace cuesta {

/// Totals, block places and roots: all that needs no page. Says whether pages can be walked at all.
bool check_directory(const Directory& directory, std::uint64_t file_bytes, VerifyReport& report);

/// The sum of owned vertices. A wedge that one page orphans another may keep: it then counts twice.
void check_vertex_total(const Directory& directory, std::uint64_t orphans, VerifyReport& report);

/// One entry against its page. @param positions one per local vertex.
void check_entry(PageId id, const PageEntry& entry, const Page& page, std::span<const Vec3i> positions,
                 const ReplayedSurvivors& survivors, VerifyReport& report);

/// For each page, the pages of the round before that name it as coarser, ascending.
std::vector<std::vector<PageId>> source_pages(const Directory& directory);

/// Every page after all its sources, and otherwise as near to them as a walk from the base page allows.
std::vector<PageId> finer_first_order(const std::vector<std::vector<PageId>>& sources);

}  // namespace cuesta
