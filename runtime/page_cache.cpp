#include "runtime/page_cache.h"

#include <algorithm>

#include "ooc/check.h"

namespace cuesta {
namespace {

/// Estimate of a page's bytes once resident, from its directory entry: pages of scans take 0.6 to 0.9 of it.
/// Points with thousands of neighbours take more, so enter() is followed by a look at what it really took.
std::uint64_t expected_bytes(const PageEntry& e, bool texcoords) {
  return std::uint64_t{e.vertices} * 28 + std::uint64_t{e.triangles} * 24 +
         std::uint64_t{e.owned_vertices} * (texcoords ? 80 : 72) + std::uint64_t{e.owned_triangles} * 24 +
         8192;
}

}  // namespace

PageCache::PageCache(CuestaFile file, std::uint64_t budget_bytes)
    : file_(std::move(file)), budget_bytes_(budget_bytes), pool_(directory().has_texcoords) {
  pages_.resize(directory().pages.size());
  failed_.assign(pages_.size(), 0);
  least_room_.assign(pages_.size(), 0);
}

Result<std::unique_ptr<PageCache>> PageCache::open(CuestaFile file, std::uint64_t budget_bytes) {
  std::unique_ptr<PageCache> cache(new PageCache(std::move(file), budget_bytes));
  const PageId base = cache->directory().base();
  if (auto r = cache->enter(base); !r) return fail(r.error());
  if (cache->resident_bytes_ > budget_bytes)
    return fail(ErrorCode::out_of_budget, cache->file_.path().string(), "page " + std::to_string(base),
                "the coarsest page takes " + std::to_string(cache->resident_bytes_) +
                    " bytes, the budget is " + std::to_string(budget_bytes) + "; give a larger cache");
  return cache;
}

bool PageCache::loadable(PageId id) const {
  if (pages_[id] || failed_[id]) return false;
  const auto& coarser = directory().pages[id].coarser;
  return std::all_of(coarser.begin(), coarser.end(), [this](PageId c) { return pages_[c] != nullptr; });
}

Result<void> PageCache::enter(PageId id) {
  auto page = file_.read_page(id);
  if (!page) return fail(page.error());
  counters_.bytes_read += directory().pages[id].block.bytes;
  std::vector<ResidentPage*> coarser;
  for (PageId c : directory().pages[id].coarser) coarser.push_back(pages_[c].get());
  auto resident = ResidentPage::create(id, *page, coarser, pool_);
  if (!resident) {
    resident.error().file = file_.path().string();
    return fail(resident.error());
  }
  for (ResidentPage* c : coarser) ++c->finer_residents;
  pages_[id] = std::move(*resident);
  resident_bytes_ += pages_[id]->bytes();
  resident_ids_.insert(std::lower_bound(resident_ids_.begin(), resident_ids_.end(), id), id);
  ++counters_.loads;
  return {};
}

Result<bool> PageCache::load(PageId id, std::uint64_t frame) {
  CUESTA_CHECK(loadable(id), id);
  const PageEntry& entry = directory().pages[id];
  for (PageId c : entry.coarser)
    want(c, frame);  // whatever the file says of them: not evicted for their finer page
  if (!make_room(std::max(expected_bytes(entry, directory().has_texcoords), least_room_[id]), frame)) {
    ++counters_.refused_for_budget;
    return false;
  }
  if (auto r = enter(id); !r) {
    failed_[id] = 1;
    ++counters_.failed;
    errors_.push_back(r.error());
    return fail(r.error());
  }
  pages_[id]->last_wanted = frame;
  if (make_room(0, frame)) return true;
  least_room_[id] = pages_[id]->bytes();
  evict(id);
  ++counters_.refused_for_budget;
  return false;
}

bool PageCache::make_room(std::uint64_t bytes, std::uint64_t frame) {
  while (resident_bytes_ + bytes > budget_bytes_) {
    const ResidentPage* oldest = nullptr;
    for (PageId id : resident_ids_) {
      const ResidentPage& p = *pages_[id];
      if (id == directory().base() || p.finer_residents > 0 || !p.fully_coarse() || p.last_wanted >= frame)
        continue;
      if (!oldest || p.last_wanted < oldest->last_wanted) oldest = &p;
    }
    if (!oldest) return false;
    evict(oldest->id());
  }
  return true;
}

void PageCache::evict(PageId id) {
  for (PageId c : directory().pages[id].coarser) --pages_[c]->finer_residents;
  resident_bytes_ -= pages_[id]->bytes();
  pages_[id].reset();
  resident_ids_.erase(std::lower_bound(resident_ids_.begin(), resident_ids_.end(), id));
  ++counters_.evictions;
}

}  // namespace cuesta
