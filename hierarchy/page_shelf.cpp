#include "hierarchy/page_shelf.h"

namespace cuesta {
namespace {

template <class T>
std::uint64_t bytes_of(const std::vector<T>& v) {
  return v.capacity() * sizeof(T);
}

}  // namespace

std::uint64_t memory_bytes(const Page& page) {
  std::uint64_t bytes = sizeof(Page) + bytes_of(page.triangles) + bytes_of(page.wedge_tails) +
                        bytes_of(page.orphans) + bytes_of(page.script.fans) + bytes_of(page.script.children) +
                        bytes_of(page.owned.positions) + bytes_of(page.owned.normals) +
                        bytes_of(page.owned.colours) + bytes_of(page.owned.texcoords);
  for (const PageSource& s : page.sources)
    bytes += sizeof s + bytes_of(s.triangles) + bytes_of(s.vertices) + bytes_of(s.local_vertices);
  return bytes;
}

Result<std::shared_ptr<const Page>> PageShelf::take(PageId id, const Read& read) {
  std::unique_lock lock(mutex_);
  while (true) {
    const auto [at, is_new] = entries_.try_emplace(id);
    if (is_new) break;
    if (at->second.page) {
      ++counts_.hits;
      order_.splice(order_.begin(), order_, at->second.order);
      return at->second.page;
    }
    read_.wait(lock);
  }
  ++counts_.reads;
  lock.unlock();
  auto page = read();
  lock.lock();
  if (page)
    keep(id, *page);
  else
    entries_.erase(id);
  read_.notify_all();
  return page;
}

void PageShelf::keep(PageId id, const std::shared_ptr<const Page>& page) {
  Entry& entry = entries_[id];
  entry.page = page;
  entry.bytes = memory_bytes(*page);
  order_.push_front(id);
  entry.order = order_.begin();
  counts_.bytes += entry.bytes;
  while (counts_.bytes > budget_bytes_ && order_.size() > 1) {
    const auto oldest = entries_.find(order_.back());
    counts_.bytes -= oldest->second.bytes;
    entries_.erase(oldest);
    order_.pop_back();
  }
}

PageShelf::Counts PageShelf::counts() const {
  const std::lock_guard lock(mutex_);
  return counts_;
}

}  // namespace cuesta
