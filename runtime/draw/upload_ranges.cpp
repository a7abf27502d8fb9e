#include "runtime/draw/upload_ranges.h"

#include <algorithm>

#include "ooc/check.h"

namespace cuesta {
namespace {

std::uint64_t end_of(const Range& r) {
  return std::uint64_t{r.first} + r.count;
}

/// @pre sorted by first.
void merge_neighbours(std::vector<Range>& ranges, std::uint64_t gap) {
  std::size_t kept = 0;
  for (const Range& r : ranges) {
    if (kept > 0 && r.first <= end_of(ranges[kept - 1]) + gap) {
      Range& last = ranges[kept - 1];
      last.count = static_cast<std::uint32_t>(std::max(end_of(last), end_of(r)) - last.first);
    } else {
      ranges[kept++] = r;
    }
  }
  ranges.resize(kept);
}

}  // namespace

std::vector<Range> coalesce(std::span<const Range> changed, std::uint32_t gap, std::size_t most) {
  CUESTA_CHECK(gap > 0 && most > 0, gap, most);
  std::vector<Range> ranges(changed.begin(), changed.end());
  std::erase_if(ranges, [](const Range& r) { return r.count == 0; });
  std::sort(ranges.begin(), ranges.end(), [](const Range& a, const Range& b) { return a.first < b.first; });
  merge_neighbours(ranges, gap);
  for (std::uint64_t wider = gap; ranges.size() > most;) merge_neighbours(ranges, wider *= 2);
  return ranges;
}

}  // namespace cuesta
