#include "runtime/page_demand.h"

#include <algorithm>

namespace cuesta {

std::span<const WantedPage> PageDemand::find(const PageCache& cache, const ErrorScale& scale, double tau) {
  const Directory& d = cache.directory();
  seen_.resize(d.pages.size(), 0);
  ++walk_;
  wanted_.clear();
  stack_.assign(1, d.base());
  while (!stack_.empty()) {
    const PageId id = stack_.back();
    stack_.pop_back();
    if (seen_[id] == walk_ || cache.failed(id)) continue;
    const auto& coarser = d.pages[id].coarser;
    // It is seen again from the last of its coarser pages that is wanted.
    if (!std::all_of(coarser.begin(), coarser.end(), [&](PageId c) { return seen_[c] == walk_; })) continue;
    const PageEntry& e = d.pages[id];
    const double sse = scale.sse(decode_error(e.largest_error), e.bound, scale.page_factor(e.bound));
    if (!(sse > tau)) continue;
    seen_[id] = walk_;
    wanted_.push_back({sse, id});
    for (const PageId f : cache.finer(id)) stack_.push_back(f);
  }
  std::sort(wanted_.begin(), wanted_.end(), [](const WantedPage& a, const WantedPage& b) {
    return a.sse != b.sse ? a.sse > b.sse : a.id > b.id;
  });
  return wanted_;
}

double PageDemand::affordable(const PageCache& cache, double tau) const {
  const PageId base = cache.directory().base();
  std::uint64_t bytes = cache.charge(base);
  for (const WantedPage& w : wanted_) {
    if (w.id == base) continue;
    bytes += cache.charge(w.id);
    if (bytes > cache.budget_bytes()) return w.sse;
  }
  return tau;
}

}  // namespace cuesta
