#include "hierarchy/page_positions.h"

#include "hierarchy/survivor_places.h"

namespace cuesta {
namespace {

std::uint64_t bytes_of(const PagePositions::Known& k) {
  std::uint64_t n = k.positions.size() * sizeof(Vec3i);
  for (const PageSource& s : k.sources) n += 4 * (s.triangles.size() + s.vertices.size() * 2);
  return n;
}

}  // namespace

std::shared_ptr<const PagePositions::Known> PagePositions::of(PageId id) {
  complaint_.clear();
  return resolve(id);
}

std::optional<std::vector<Vec3i>> PagePositions::survivors(PageId id) {
  complaint_.clear();
  return find_survivors(id);
}

/// Recursion goes up one round per level; decode_directory has checked that pages lean on the next round
/// only.
std::shared_ptr<const PagePositions::Known> PagePositions::resolve(PageId id) {
  if (const auto it = entries_.find(id); it != entries_.end()) {
    order_.splice(order_.begin(), order_, it->second.used);
    return it->second.known;
  }
  std::shared_ptr<Known> known;
  if (const auto survivors = find_survivors(id))
    if (auto page = file_.read_page(id, *survivors))
      known = std::make_shared<Known>(Known{local_positions(*page), std::move(page->sources)});
  remember(id, known);
  return known;
}

std::optional<std::vector<Vec3i>> PagePositions::find_survivors(PageId id) {
  SurvivorPlaces survivors(file_.directory().pages[id]);
  for (PageId c : file_.directory().pages[id].coarser) {
    const auto coarser = resolve(c);
    if (!coarser) return {};
    for (const PageSource& s : coarser->sources)
      if (s.page == id)
        survivors.add(s.vertices, s.local_vertices,
                      [&coarser](std::uint32_t v) { return coarser->positions[v]; });
  }
  const auto missing = survivors.missing();
  if (!missing) return survivors.places();
  complaint_ = "survivor " + std::to_string(*missing) + " of page " + std::to_string(id) +
               " is in none of the coarser pages";
  return {};
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
