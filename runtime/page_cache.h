#pragma once
/// Resident pages under a byte budget. A page is usable when its coarser pages are resident; the base page
/// always is.

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "hierarchy/cuesta_file.h"
#include "runtime/geometry_pool.h"
#include "runtime/resident_page.h"

namespace cuesta {

struct CacheCounters {
  std::uint64_t loads = 0;
  std::uint64_t evictions = 0;
  std::uint64_t bytes_read = 0;
  std::uint64_t refused_for_budget = 0;  ///< wanted, but nothing evictable would have made room
  std::uint64_t failed = 0;              ///< unreadable; not tried again
};

class PageCache {
 public:
  /// Loads the base page. @error of reading it; out_of_budget when it alone is larger than `budget_bytes`.
  static Result<std::unique_ptr<PageCache>> open(CuestaFile file, std::uint64_t budget_bytes);

  const Directory& directory() const { return file_.directory(); }
  GeometryPool& pool() { return pool_; }
  ResidentPage* resident(PageId id) { return pages_[id].get(); }
  std::span<const PageId> resident_ids() const { return resident_ids_; }
  std::uint64_t resident_bytes() const { return resident_bytes_; }
  std::uint64_t budget_bytes() const { return budget_bytes_; }
  void set_budget_bytes(std::uint64_t bytes) { budget_bytes_ = bytes; }

  /// True if all pages that `id` leans on are resident, and `id` is not and has not failed.
  bool loadable(PageId id) const;
  bool failed(PageId id) const { return failed_[id] != 0; }
  /// Marks a resident page as wanted in this frame: not evicted while it is.
  void want(PageId id, std::uint64_t frame) { pages_[id]->last_wanted = frame; }
  /// Reads, decodes and enters a page, evicting fully coarse pages not wanted in `frame`, least recently
  /// wanted first.
  /// @return false if the budget has no room. @error of reading the page, which is then never tried again.
  /// @pre loadable(id).
  Result<bool> load(PageId id, std::uint64_t frame);

  const CacheCounters& counters() const { return counters_; }
  /// Errors of pages that could not be read, in the order of the attempts.
  std::span<const Error> errors() const { return errors_; }

 private:
  PageCache(CuestaFile file, std::uint64_t budget_bytes);
  bool make_room(std::uint64_t bytes, std::uint64_t frame);
  void evict(PageId id);
  Result<void> enter(PageId id);

  CuestaFile file_;
  std::uint64_t budget_bytes_;
  GeometryPool pool_;  // outlives the pages
  std::vector<std::unique_ptr<ResidentPage>> pages_;
  std::vector<std::uint8_t> failed_;
  std::vector<std::uint64_t> least_room_;  // per page: what it took when that did not fit; else 0
  std::vector<PageId> resident_ids_;       // ascending
  std::uint64_t resident_bytes_ = 0;
  CacheCounters counters_;
  std::vector<Error> errors_;
};

}  // namespace cuesta
