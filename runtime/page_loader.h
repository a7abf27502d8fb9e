#pragma once
/// Reads, decodes and replays pages, off the frame's thread or, where there are no threads, on it.

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <vector>

#include "hierarchy/cuesta_file.h"
#include "runtime/resident_page.h"

namespace cuesta {

/// A page to be made resident. Its coarser pages are, and stay so until the page is handed over.
struct PageRequest {
  PageId id = 0;
  GeometryPool::RunId run = GeometryPool::no_run;
  GeometryPool::PageRun blocks;  ///< a copy: the pool's own may move
  std::vector<const ResidentPage*> coarser;
};

struct LoadedPage {
  PageId id = 0;
  GeometryPool::RunId run = GeometryPool::no_run;
  Result<std::unique_ptr<ResidentPage>> page;
};

/// Threads: one caller.
class PageLoader {
 public:
  virtual ~PageLoader() = default;
  virtual void request(PageRequest request) = 0;
  /// A page that is done, in any order; nothing when none is.
  virtual std::optional<LoadedPage> finished() = 0;
  /// Returns when a page is done or none is under way.
  virtual void wait() = 0;
  /// Requests that it takes before they only queue.
  virtual std::uint32_t width() const = 0;
  /// True if request() does it all, on the caller's time.
  virtual bool is_inline() const { return false; }
};

/// Reads, decodes and replays one page: what any loader does. Memory that the machine refuses is the page's
/// error.
LoadedPage load_page(const CuestaFile& file, GeometryPool& pool, const PageRequest& request);

/// Makes the loader of an open file, which outlives it with its pool.
using MakePageLoader = std::function<std::unique_ptr<PageLoader>(const CuestaFile& file, GeometryPool& pool)>;

/// @param threads  that read and decode; 0: request() does it all.
MakePageLoader page_loader(std::uint32_t threads);

}  // namespace cuesta
