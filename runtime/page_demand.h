#pragma once
/// Which pages a view asks for: those with a substitution that it does not want applied.

#include <cstdint>
#include <span>
#include <vector>

#include "runtime/error_scale.h"
#include "runtime/page_cache.h"

namespace cuesta {

struct WantedPage {
  double sse;  ///< the largest of its substitutions' and of those of all pages that lean on it
  PageId id;
};

class PageDemand {
 public:
  /// Walks the page graph from the base as far as sse > `tau`. A page comes after those it leans on, and else
  /// the worst first; pages that cannot be read are left out, with all that lean on them.
  /// @cost O(pages found · log), no allocation after warm-up.
  std::span<const WantedPage> find(const PageCache& cache, const ErrorScale& scale, double tau);

  /// What the last find() found.
  std::span<const WantedPage> wanted() const { return wanted_; }

  /// The least threshold, at least `tau`, at which the pages found for `tau` fit the cache's budget.
  double affordable(const PageCache& cache, double tau) const;

 private:
  std::vector<WantedPage> wanted_;
  std::vector<PageId> stack_;
  std::vector<std::uint32_t> seen_;
  std::uint32_t walk_ = 0;
};

}  // namespace cuesta
