#pragma once
/// Reads, decodes and replays pages, off the frame's thread or, where there are no threads, on it.

#include <cstdint>
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
};

/// @param file, pool  outlive the loader.
/// @param threads  that read and decode; 0: request() does it all.
std::unique_ptr<PageLoader> make_page_loader(const CuestaFile& file, GeometryPool& pool, std::uint32_t threads);

}  // namespace cuesta
