#pragma once
/// Resident pages under a byte budget. A page is usable when its coarser pages are resident; the base page
/// always is. Pages are asked for, arrive when they are decoded and their vertices uploaded, and are evicted
/// only to make room for others.

#include <cstdint>
#include <deque>
#include <memory>
#include <span>
#include <vector>

#include "hierarchy/cuesta_file.h"
#include "runtime/geometry_pool.h"
#include "runtime/page_loader.h"
#include "runtime/resident_page.h"

namespace cuesta {

struct CacheCounters {
  std::uint64_t loads = 0;
  std::uint64_t evictions = 0;
  std::uint64_t bytes_read = 0;
  std::uint64_t refused_for_budget = 0;  ///< asked for, but nothing evictable would have made room
  std::uint64_t failed = 0;              ///< unreadable; not tried again
  std::uint64_t prefetched = 0;          ///< of the loads: asked for before they were wanted
};

class PageCache {
 public:
  /// Loads the base page.
  /// @param load_threads  that read and decode; 0: requests are carried out at once, on the caller's thread.
  /// @error of reading the base page; out_of_budget when it alone is larger than `budget_bytes`.
  static Result<std::unique_ptr<PageCache>> open(CuestaFile file, std::uint64_t budget_bytes,
                                                 std::uint32_t load_threads = 0) {
    return open(std::move(file), budget_bytes, page_loader(load_threads));
  }
  /// @param make_loader  of what brings the pages. The base page must be done when its request has been
  /// waited for.
  static Result<std::unique_ptr<PageCache>> open(CuestaFile file, std::uint64_t budget_bytes,
                                                 const MakePageLoader& make_loader);

  const Directory& directory() const { return file_.directory(); }
  GeometryPool& pool() { return pool_; }
  const GeometryPool& pool() const { return pool_; }
  ResidentPage* resident(PageId id) { return pages_[id].get(); }
  const ResidentPage* resident(PageId id) const { return pages_[id].get(); }
  std::span<const PageId> resident_ids() const { return resident_ids_; }  ///< ascending: finer first
  /// Pages that have `id` among their coarser pages.
  std::span<const PageId> finer(PageId id) const {
    return std::span(finer_).subspan(first_finer_[id], first_finer_[id + 1] - first_finer_[id]);
  }

  /// What resident pages are charged, and those on their way; never above the budget. At least what they
  /// take, pool included. Beyond it are a page per loading thread while it is decoded, and 40 bytes for every
  /// page of the file.
  std::uint64_t resident_bytes() const { return resident_bytes_; }
  std::uint64_t charge(PageId id) const { return charge_[id]; }
  std::uint64_t budget_bytes() const { return budget_bytes_; }
  void set_budget_bytes(std::uint64_t bytes) { budget_bytes_ = bytes; }

  bool failed(PageId id) const { return state_[id] == State::failed; }
  bool on_its_way(PageId id) const { return state_[id] == State::on_its_way; }
  std::uint32_t on_their_way() const { return on_their_way_; }
  /// True if the page is neither there, on its way nor unreadable, and all that it leans on are there.
  bool requestable(PageId id) const;
  bool loads_inline() const { return loader_->is_inline(); }
  bool busy() const { return on_their_way_ >= loader_->width(); }
  /// Marks a resident page as wanted in this frame: not evicted while it is.
  void want(PageId id, std::uint64_t frame) { pages_[id]->last_wanted = frame; }
  /// Asks for a page, evicting fully coarse pages that were not wanted since `keep_since`, least recently
  /// wanted first. The pages that it leans on stay until it is there.
  /// @return false if there is no room.   @pre requestable(id).
  bool request(PageId id, std::uint64_t keep_since, bool prefetch = false);
  /// Takes in pages that are done, as far as `upload_bytes` goes for their vertices. One that cannot be read
  /// is among errors() from then on.
  /// @return pages that have become resident.
  std::uint32_t take_in(std::uint64_t frame, std::uint64_t upload_bytes);
  /// Returns when there is something to take in, or nothing is on its way.
  void wait() {
    if (arriving_.empty()) loader_->wait();
  }

  const CacheCounters& counters() const { return counters_; }
  /// Errors of pages that could not be read, in the order of the attempts.
  std::span<const Error> errors() const { return errors_; }

 private:
  enum class State : std::uint8_t { absent, on_its_way, resident, failed };

  PageCache(CuestaFile file, std::uint64_t budget_bytes, const MakePageLoader& make_loader);
  void link_finer();
  Result<void> load_base();
  bool make_room(PageId id, std::uint64_t keep_since);
  void send(PageId id);
  Error base_too_large() const;
  void decoded(LoadedPage loaded);
  void lean(PageId id, bool on);
  void let_go(PageId id, GeometryPool::RunId run, State state);
  void evict(PageId id);

  CuestaFile file_;
  std::uint64_t budget_bytes_;
  std::vector<std::uint64_t> charge_;
  GeometryPool pool_;
  std::vector<std::unique_ptr<ResidentPage>> pages_;
  std::vector<State> state_;
  std::vector<std::uint32_t> first_finer_;
  std::vector<PageId> finer_;
  std::vector<PageId> resident_ids_;
  std::deque<std::unique_ptr<ResidentPage>> arriving_;  // decoded; their vertices are being uploaded
  std::uint64_t resident_bytes_ = 0;
  std::uint32_t on_their_way_ = 0;
  CacheCounters counters_;
  std::vector<Error> errors_;
  std::unique_ptr<PageLoader> loader_;  // goes first: its threads use the rest
};

}  // namespace cuesta
