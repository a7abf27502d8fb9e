#pragma once
/// Decoded pages of one file, shared by several who look at it, under a byte budget.

#include <condition_variable>
#include <cstdint>
#include <functional>
#include <list>
#include <memory>
#include <mutex>
#include <unordered_map>

#include "hierarchy/page.h"
#include "ooc/result.h"

namespace cuesta {

/// About what a decoded page takes.
std::uint64_t memory_bytes(const Page& page);

/// Threads: any. Pages that somebody holds live on when the shelf has forgotten them.
class PageShelf {
 public:
  using Read = std::function<Result<std::shared_ptr<const Page>>()>;

  explicit PageShelf(std::uint64_t budget_bytes) : budget_bytes_(budget_bytes) {}

  /// The page, read by `read` if it is not there. Who asks while it is being read waits for it; an error is
  /// not kept. Pages taken longest ago go when the budget is exceeded.
  Result<std::shared_ptr<const Page>> take(PageId id, const Read& read);

  struct Counts {
    std::uint64_t bytes = 0, hits = 0, reads = 0;
  };
  Counts counts() const;

 private:
  struct Entry {
    std::shared_ptr<const Page> page;  ///< null while it is being read
    std::uint64_t bytes = 0;
    std::list<PageId>::iterator order;
  };
  void keep(PageId id, const std::shared_ptr<const Page>& page);

  const std::uint64_t budget_bytes_;
  mutable std::mutex mutex_;
  std::condition_variable read_;
  std::unordered_map<PageId, Entry> entries_;
  std::list<PageId> order_;  // of those that are there, the last taken in front
  Counts counts_;
};

}  // namespace cuesta
