#include "apps/verify/slot_points.h"

#include <algorithm>
#include <numeric>
#include <string>

#include "hierarchy/page_positions.h"

namespace cuesta::verify {
namespace {

constexpr std::uint32_t unknown = 0xFFFFFFFFu;
constexpr std::uint64_t position_bytes = std::uint64_t{64} << 20;

class SlotFinder {
 public:
  SlotFinder(const CuestaFile& file, PageCache& cache, std::size_t slots)
      : file_(file),
        cache_(cache),
        positions_(file, position_bytes),
        point_(slots),
        slots_(file.directory().pages.size()),
        sources_(slots_.size()) {
    std::iota(point_.begin(), point_.end(), 0u);
  }

  /// Coarser pages come last and are needed first.
  Result<std::vector<std::uint32_t>> run() {
    for (PageId id = static_cast<PageId>(slots_.size()); id-- > 0;) {
      auto page = read(id);
      if (!page) return fail(page.error());
      find_slots(id, *page);
      for (std::uint32_t v : page->wedge_tails) join(slots_[id][v - 1], slots_[id][v]);
      sources_[id] = std::move(page->sources);
    }
    for (std::uint32_t s = 0; s < point_.size(); ++s) point_[s] = root(s);
    return std::move(point_);
  }

 private:
  Result<Page> read(PageId id) {
    const auto survivors = positions_.survivors(id);
    if (survivors) return file_.read_page(id, *survivors);
    return fail(ErrorCode::corrupt, file_.path().string(), "page " + std::to_string(id),
                positions_.complaint());
  }

  void find_slots(PageId id, const Page& page) {
    auto& slots = slots_[id];
    slots.assign(page.vertex_count, unknown);
    const auto owned = owned_vertices(page);
    number_owned(page, *cache_.resident(id), owned, slots);
    std::vector<std::uint32_t> survivors;
    for (std::uint32_t v = 0; v < page.vertex_count; ++v)
      if (!owned[v]) survivors.push_back(v);
    for (PageId c : file_.directory().pages[id].coarser)
      for (const PageSource& s : sources_[c])
        for (std::size_t i = 0; s.page == id && i < s.vertices.size(); ++i)
          slots[survivors[s.vertices[i]]] = slots_[c][s.local_vertices[i]];
  }

  /// Owned vertices have consecutive slots in local order; any substitution tells where they begin.
  static void number_owned(const Page& page, const ResidentPage& resident,
                           const std::vector<std::uint8_t>& owned, std::vector<std::uint32_t>& slots) {
    if (page.script.children.empty()) return;
    const std::uint32_t known = page.script.children.front().vertex;
    std::uint32_t slot = resident.children(resident.fans().front()).front().from_slot -
                         static_cast<std::uint32_t>(std::count(owned.begin(), owned.begin() + known, 1));
    for (std::uint32_t v = 0; v < slots.size(); ++v)
      if (owned[v]) slots[v] = slot++;
  }

  std::uint32_t root(std::uint32_t s) {
    while (point_[s] != s) s = point_[s] = point_[point_[s]];
    return s;
  }
  void join(std::uint32_t a, std::uint32_t b) {
    if (a == unknown || b == unknown) return;  // of a page that removes nothing
    a = root(a);
    b = root(b);
    point_[std::max(a, b)] = std::min(a, b);
  }

  const CuestaFile& file_;
  PageCache& cache_;
  PagePositions positions_;
  std::vector<std::uint32_t> point_;
  std::vector<std::vector<std::uint32_t>> slots_;  // per page and local vertex
  std::vector<std::vector<PageSource>> sources_;
};

}  // namespace

Result<std::vector<std::uint32_t>> slot_points(const CuestaFile& file, PageCache& cache, std::size_t slots) {
  return SlotFinder(file, cache, slots).run();
}

}  // namespace cuesta::verify
