#include "runtime/resident_page.h"

#include <algorithm>

#include "ooc/check.h"

namespace cuesta {

const ResidentPage::SourceTable* ResidentPage::source(PageId finer) const {
  for (const SourceTable& s : sources_)
    if (s.page == finer) return &s;
  return nullptr;
}

void ResidentPage::place_survivors(PageId finer, SurvivorPlaces& places) const {
  if (const SourceTable* s = source(finer))
    places.add(s->vertices, s->local_vertices, [this](std::uint32_t v) {
      const DrawVertex& at = pool_.vertex(vertex_slot_[v]);
      return Vec3i{at.x, at.y, at.z};
    });
}

void ResidentPage::apply_next(FanState& f) {
  CUESTA_CHECK(f.applied < f.child_count);
  do {
    const std::uint32_t k = f.first_child + f.applied;
    const ChildState& c = children_[k];
    const std::uint32_t modified = c.first_entry + c.removed;
    for (std::uint32_t e = c.first_entry; e < modified; ++e) pool_.deactivate(entries_[e]);
    for (std::uint32_t e = modified; e < children_[k + 1].first_entry; ++e)
      pool_.set_corner(entries_[e] / 4, entries_[e] % 4, c.to_slot);
    ++f.applied;
    ++applied_;
  } while (f.applied < f.child_count && children_[f.first_child + f.applied].joined);
}

void ResidentPage::undo_last(FanState& f) {
  CUESTA_CHECK(f.applied > 0);
  bool joined = true;
  while (joined) {
    --f.applied;
    --applied_;
    const std::uint32_t k = f.first_child + f.applied;
    const ChildState& c = children_[k];
    const std::uint32_t modified = c.first_entry + c.removed;
    for (std::uint32_t e = modified; e < children_[k + 1].first_entry; ++e)
      pool_.set_corner(entries_[e] / 4, entries_[e] % 4, c.from_slot);
    for (std::uint32_t e = c.first_entry; e < modified; ++e) pool_.activate(entries_[e]);
    joined = c.joined;
  }
}

void ResidentPage::move_fan(std::size_t fan, std::uint16_t goal) {
  FanState& f = fans_[fan];
  while (f.applied < goal) apply_next(f);
  while (f.applied > goal) undo_last(f);
  update_band(fan);
}

std::uint32_t ResidentPage::undo_gain(std::size_t fan, std::uint16_t goal) const {
  const FanState& f = fans_[fan];
  std::uint32_t gain = 0;
  for (std::uint32_t i = goal; i < f.applied; ++i) gain += children_[f.first_child + i].removed;
  return gain;
}

std::uint32_t ResidentPage::entries_between(std::size_t fan, std::uint16_t goal) const {
  const FanState& f = fans_[fan];
  const std::uint32_t a = children_[f.first_child + f.applied].first_entry;
  const std::uint32_t b = children_[f.first_child + goal].first_entry;
  return a < b ? b - a : a - b;
}

std::uint16_t ResidentPage::one_undone(std::size_t fan) const {
  const FanState& f = fans_[fan];
  std::uint16_t goal = f.applied;
  do --goal;
  while (goal > 0 && children_[f.first_child + goal].joined);
  return goal;
}

void ResidentPage::activate_survivors() {
  for (const TriangleHandle t : survivors_) pool_.activate(t);
  survivors_ = {};
}

bool ResidentPage::set_path(FanPath path) {
  if (path == path_) return false;
  path_ = path;
  for (std::size_t f = 0; f < fans_.size(); ++f) update_band(f);
  return true;
}

void ResidentPage::update_band(std::size_t fan) {
  const FanState& f = fans_[fan];
  const auto error = [&](std::uint32_t i) { return children_[f.first_child + i].error; };
  FanBand band;
  if (f.applied > 0) band.undo_below = error(f.applied - 1u);
  if (f.applied < f.child_count)
    band.apply_from = error(path_ == FanPath::fine ? f.applied : f.child_count - 1u);
  nodes_.set_band(static_cast<std::uint32_t>(fan), band);
}

void ResidentPage::tag_changes(std::size_t fan, std::uint16_t from, std::uint8_t kind) {
  const FanState& f = fans_[fan];
  const std::uint32_t first = f.first_child + std::min(f.applied, from);
  const std::uint32_t last = f.first_child + std::max(f.applied, from);
  for (std::uint32_t k = first; k < last; ++k)
    for_each_changed(children_[k], [&](TriangleHandle t) { pool_.tag(t, kind); });
}

std::uint64_t ResidentPage::bytes() const {
  std::uint64_t b = vertex_slot_.size() * 4 + triangle_ref_.size() * 4 + fans_.size() * sizeof(FanState) +
                    spheres_.size() * sizeof(Sphere) + children_.size() * sizeof(ChildState) +
                    entries_.size() * 4 + nodes_.bytes();
  for (const auto& s : sources_) b += (s.triangles.size() + s.vertices.size() + s.local_vertices.size()) * 4;
  return b;
}

}  // namespace cuesta
