#pragma once
/// Which vertex slots are one point of the surface: the pages' wedge groups, in the pool's numbers.

#include <cstdint>
#include <vector>

#include "hierarchy/cuesta_file.h"
#include "runtime/page_cache.h"

namespace cuesta::verify {

/// @param cache  of the same file, all pages resident
/// @return per slot the lowest slot of its point; slots that nothing uses are their own.
/// @error of reading a page.   @cost every page is read once; 4 bytes per local vertex of all pages.
Result<std::vector<std::uint32_t>> slot_points(const CuestaFile& file, PageCache& cache, std::size_t slots);

}  // namespace cuesta::verify
