#include "hierarchy/page_positions.h"

#include <algorithm>

namespace cuesta {
namespace {

std::uint64_t bytes_of(const PagePositions::Known& k) {
  std::uint64_t n = k.positions.size() * sizeof(Vec3i);
  for (const PageSource& s : k.sources) n += 4 * (s.triangles.size() + s.vertices.size() * 2);
  return n;
}

/// Local numbers of the vertices that survive.
std::vector<std::uint32_t> survivors_of(const std::vector<std::uint8_t>& owned) {
  std::vector<std::uint32_t> out;
  for (std::uint32_t v = 0; v < owned.size(); ++v)
    if (!owned[v]) out.push_back(v);
  return out;
}

}  // namespace

std::shared_ptr<const PagePositions::Known> PagePositions::of(PageId id) {
  complaint_.clear();
  return resolve(id);
}

/// Recursion goes up one round per level; decode_directory has checked that pages lean on the next round
/// only.
std::shared_ptr<const PagePositions::Known> PagePositions::resolve(PageId id) {
  if (const auto it = entries_.find(id); it != entries_.end()) {
    order_.splice(order_.begin(), order_, it->second.used);
    return it->second.known;
  }
  std::shared_ptr<Known> known;
  if (auto page = file_.read_page(id)) {
    known = std::make_shared<Known>();
    if (fill_survivors(id, *page, *known))
      known->sources = std::move(page->sources);
    else
      known = nullptr;
  }
  remember(id, known);
  return known;
}

bool PagePositions::fill_survivors(PageId id, const Page& page, Known& known) {
  const auto owned = owned_vertices(page);
  const auto survivors = survivors_of(owned);
  known.positions.resize(page.vertex_count);
  std::size_t next = 0;
  for (std::uint32_t v = 0; v < page.vertex_count; ++v)
    if (owned[v]) known.positions[v] = page.owned.positions[next++];
  std::vector<std::uint8_t> found(survivors.size(), 0);
  for (PageId c : file_.directory().pages[id].coarser) {
    const auto coarser = resolve(c);
    if (!coarser) return false;
    for (const PageSource& s : coarser->sources) {
      if (s.page != id) continue;
      for (std::size_t i = 0; i < s.vertices.size(); ++i) {
        if (s.vertices[i] >= survivors.size()) continue;  // found by the check of source tables
        known.positions[survivors[s.vertices[i]]] = coarser->positions[s.local_vertices[i]];
        found[s.vertices[i]] = 1;
      }
    }
  }
  const auto missing = std::find(found.begin(), found.end(), std::uint8_t{0});
  if (missing == found.end()) return true;
  complaint_ = "surviving vertex " +
               std::to_string(survivors[static_cast<std::size_t>(missing - found.begin())]) + " of page " +
               std::to_string(id) + " is in none of the coarser pages";
  return false;
}

void PagePositions::remember(PageId id, std::shared_ptr<const Known> known) {
  bytes_ += known ? bytes_of(*known) : 0;
  order_.push_front(id);
  entries_[id] = {std::move(known), order_.begin()};
  while (bytes_ > budget_ && order_.size() > 1) {
    const auto last = entries_.find(order_.back());
    bytes_ -= last->second.known ? bytes_of(*last->second.known) : 0;
    entries_.erase(last);
    order_.pop_back();
  }
}

}  // namespace cuesta
