#include "runtime/page_cache.h"

#include <algorithm>
#include <limits>

#include "ooc/check.h"

namespace cuesta {
namespace {

/// Bytes of a resident page without its share of the pool, from its directory entry: scans take 0.85 to 0.97
/// of it. Points with thousands of neighbours take more, which is seen when they are there.
std::uint64_t expected_table_bytes(const PageEntry& e) {
  const std::uint64_t sources =
      e.round > 0 ? std::uint64_t{e.vertices} * 8 + std::uint64_t{e.triangles} * 4 : 0;
  return std::uint64_t{e.vertices} * 4 + std::uint64_t{e.triangles} * 4 + sources +
         std::uint64_t{e.owned_vertices} * 70 + 4096;
}

std::vector<std::uint64_t> charges_of(const Directory& directory) {
  std::vector<std::uint64_t> charges;
  for (const PageEntry& e : directory.pages)
    charges.push_back(expected_table_bytes(e) +
                      GeometryPool::page_bytes(e.owned_vertices, e.owned_triangles, directory.has_texcoords));
  return charges;
}

}  // namespace

PageCache::PageCache(CuestaFile file, std::uint64_t budget_bytes, const MakePageLoader& make_loader)
    : file_(std::move(file)),
      budget_bytes_(budget_bytes),
      charge_(charges_of(directory())),
      pool_(GeometryPool::capacity_for(directory(), budget_bytes, charge_), directory().has_texcoords),
      loader_(make_loader(file_, pool_)) {
  const auto& entries = directory().pages;
  pages_.resize(entries.size());
  state_.assign(entries.size(), State::absent);
  link_finer();
}

void PageCache::link_finer() {
  const auto& entries = directory().pages;
  first_finer_.assign(entries.size() + 1, 0);
  for (const PageEntry& e : entries)
    for (PageId c : e.coarser) ++first_finer_[c + 1];
  for (std::size_t i = 0; i < entries.size(); ++i) first_finer_[i + 1] += first_finer_[i];
  finer_.resize(first_finer_.back());
  std::vector<std::uint32_t> at(first_finer_.begin(), first_finer_.end() - 1);
  for (PageId id = 0; id < entries.size(); ++id)
    for (PageId c : entries[id].coarser) finer_[at[c]++] = id;
}

Result<std::unique_ptr<PageCache>> PageCache::open(CuestaFile file, std::uint64_t budget_bytes,
                                                   const MakePageLoader& make_loader) {
  std::unique_ptr<PageCache> cache(new PageCache(std::move(file), budget_bytes, make_loader));
  if (auto r = cache->load_base(); !r) return fail(r.error());
  return cache;
}

Result<void> PageCache::load_base() {
  const PageId base = directory().base();
  if (!make_room(base, 0)) return fail(base_too_large());
  send(base);
  loader_->wait();
  constexpr auto all = std::numeric_limits<std::uint64_t>::max();
  if (take_in(0, all) != 1) return fail(errors_.front());
  pages_[base]->activate_survivors();
  return {};
}

Error PageCache::base_too_large() const {
  const PageId base = directory().base();
  return {ErrorCode::out_of_budget, file_.path().string(), "page " + std::to_string(base),
          "the coarsest page takes " + std::to_string(charge_[base]) + " bytes, the budget is " +
              std::to_string(budget_bytes_) + "; give a larger cache"};
}

bool PageCache::requestable(PageId id) const {
  if (state_[id] != State::absent) return false;
  const auto& coarser = directory().pages[id].coarser;
  return std::all_of(coarser.begin(), coarser.end(),
                     [this](PageId c) { return state_[c] == State::resident; });
}

bool PageCache::request(PageId id, std::uint64_t keep_since, bool prefetch) {
  CUESTA_CHECK(requestable(id), id);
  lean(id, true);  // whatever the file says of them: they are not evicted for their finer page
  if (!make_room(id, keep_since)) {
    lean(id, false);
    ++counters_.refused_for_budget;
    return false;
  }
  lean(id, false);
  counters_.prefetched += prefetch;
  send(id);
  return true;
}

void PageCache::lean(PageId id, bool on) {
  for (PageId c : directory().pages[id].coarser)
    on ? ++pages_[c]->finer_residents : --pages_[c]->finer_residents;
}

void PageCache::send(PageId id) {
  const PageEntry& e = directory().pages[id];
  lean(id, true);
  state_[id] = State::on_its_way;
  ++on_their_way_;
  resident_bytes_ += charge_[id];
  PageRequest request;
  request.id = id;
  request.run = pool_.add(e.owned_vertices, e.owned_triangles);
  request.blocks = pool_.run(request.run);
  for (PageId c : e.coarser) request.coarser.push_back(pages_[c].get());
  loader_->request(std::move(request));
}

std::uint32_t PageCache::take_in(std::uint64_t frame, std::uint64_t upload_bytes) {
  while (auto loaded = loader_->finished()) decoded(std::move(*loaded));
  std::uint32_t taken = 0;
  const std::uint64_t end = upload_bytes > std::numeric_limits<std::uint64_t>::max() - pool_.upload_bytes()
                                ? upload_bytes
                                : pool_.upload_bytes() + upload_bytes;
  while (!arriving_.empty()) {
    if (!pool_.upload_vertices(arriving_.front()->run(), end - pool_.upload_bytes())) break;
    std::unique_ptr<ResidentPage> page = std::move(arriving_.front());
    arriving_.pop_front();
    const PageId id = page->id();
    page->last_wanted = frame;
    pages_[id] = std::move(page);
    state_[id] = State::resident;
    --on_their_way_;
    resident_ids_.insert(std::lower_bound(resident_ids_.begin(), resident_ids_.end(), id), id);
    ++taken;
  }
  return taken;
}

void PageCache::decoded(LoadedPage loaded) {
  const PageId id = loaded.id;
  const PageEntry& e = directory().pages[id];
  counters_.bytes_read += e.block.bytes;
  if (!loaded.page) {
    let_go(id, loaded.run, State::failed);
    ++counters_.failed;
    errors_.push_back(loaded.page.error());
    return;
  }
  const std::uint64_t real =
      (*loaded.page)->bytes() +
      GeometryPool::page_bytes(e.owned_vertices, e.owned_triangles, pool_.has_texcoords());
  if (real > charge_[id]) {
    const std::uint64_t more = real - charge_[id];
    if (resident_bytes_ + more > budget_bytes_) {
      let_go(id, loaded.run, State::absent);
      charge_[id] = real;
      ++counters_.refused_for_budget;
      if (id == directory().base()) errors_.push_back(base_too_large());
      return;
    }
    charge_[id] = real;
    resident_bytes_ += more;
  }
  ++counters_.loads;
  arriving_.push_back(std::move(*loaded.page));
}

void PageCache::let_go(PageId id, GeometryPool::RunId run, State state) {
  lean(id, false);
  pool_.remove(run);
  resident_bytes_ -= charge_[id];
  state_[id] = state;
  --on_their_way_;
}

bool PageCache::make_room(PageId id, std::uint64_t keep_since) {
  const PageEntry& e = directory().pages[id];
  while (resident_bytes_ + charge_[id] > budget_bytes_ || !pool_.fits(e.owned_vertices, e.owned_triangles)) {
    const ResidentPage* oldest = nullptr;
    for (PageId r : resident_ids_) {
      const ResidentPage& p = *pages_[r];
      if (r == directory().base() || p.finer_residents > 0 || !p.fully_coarse() ||
          p.last_wanted >= keep_since)
        continue;
      if (!oldest || p.last_wanted < oldest->last_wanted) oldest = &p;
    }
    if (!oldest) return false;
    evict(oldest->id());
  }
  return true;
}

void PageCache::evict(PageId id) {
  lean(id, false);
  pool_.remove(pages_[id]->run());
  resident_bytes_ -= charge_[id];
  pages_[id].reset();
  state_[id] = State::absent;
  resident_ids_.erase(std::lower_bound(resident_ids_.begin(), resident_ids_.end(), id));
  ++counters_.evictions;
}

}  // namespace cuesta
