#include "runtime/geomorph.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "ooc/oct_normal.h"

namespace cuesta {
namespace {

std::int32_t mix(std::int32_t a, std::int32_t b, double w) {
  return static_cast<std::int32_t>(std::lround(a + (static_cast<double>(b) - a) * w));
}

DrawVertex mix(const DrawVertex& a, const DrawVertex& b, double w) {
  DrawVertex out = b;
  out.x = mix(a.x, b.x, w);
  out.y = mix(a.y, b.y, w);
  out.z = mix(a.z, b.z, w);
  for (std::size_t k = 0; k < 4; ++k)
    out.colour[k] = static_cast<std::uint8_t>(mix(a.colour[k], b.colour[k], w));
  const Vec3f n = decode_oct({a.normal_u, a.normal_v}, 16) * static_cast<float>(1 - w) +
                  decode_oct({b.normal_u, b.normal_v}, 16) * static_cast<float>(w);
  const auto code = encode_oct(n, 16);
  out.normal_u = code[0];
  out.normal_v = code[1];
  return out;
}

/// Without a jerk at either end.
double ease(double w) {
  return w * w * (3 - 2 * w);
}

}  // namespace

const DrawVertex& Geomorphs::shown(std::uint32_t slot) const {
  const auto it = blend_of_.find(slot);
  return it == blend_of_.end() ? pool_.vertex(slot) : blends_[it->second].now;
}

void Geomorphs::blend(std::uint32_t slot, std::uint32_t to_slot, const DrawVertex& from, bool merge) {
  const Blend b{slot, to_slot, from, from, now_ms_, merge};
  const auto [it, is_new] = blend_of_.try_emplace(slot, static_cast<std::uint32_t>(blends_.size()));
  if (is_new)
    blends_.push_back(b);
  else
    blends_[it->second] = b;
}

void Geomorphs::drop_blend(std::uint32_t slot) {
  const auto it = blend_of_.find(slot);
  if (it == blend_of_.end()) return;
  const std::uint32_t i = it->second;
  blend_of_.erase(it);
  restored_.push_back(slot);
  if (i + 1 < blends_.size()) {
    blends_[i] = blends_.back();
    blend_of_[blends_[i].slot] = i;
  }
  blends_.pop_back();
}

void Geomorphs::update(double now_ms) {
  now_ms_ = now_ms;
  lean_no_more(postponed_);
  postponed_.clear();
  for (std::size_t i = 0; i < blends_.size();) {
    Blend& b = blends_[i];
    const double w = duration_ms_ > 0 ? std::clamp((now_ms - b.start_ms) / duration_ms_, 0.0, 1.0) : 1;
    if (w == 1 && !b.merge) {
      drop_blend(b.slot);
      continue;
    }
    b.now = mix(b.from, b.merge ? shown(b.to_slot) : pool_.vertex(b.slot), ease(w));
    ++i;
  }
  for (Merge& m : merges_)
    m.due = m.due || m.slots.empty() || duration_ms_ <= 0 ||
            now_ms - blends_[blend_of_.at(m.slots.front())].start_ms >= duration_ms_;
}

std::span<const MorphedVertex> Geomorphs::morphed() {
  morphed_.clear();
  for (const Blend& b : blends_) morphed_.push_back({b.slot, b.now});
  return morphed_;
}

void Geomorphs::grow(const ResidentPage& page, std::size_t fan, std::uint16_t goal, std::uint16_t applied) {
  const auto children = page.children(page.fans()[fan]);
  for (std::uint16_t i = goal; i < applied; ++i)
    blend(children[i].from_slot, children[i].from_slot, shown(children[i].to_slot), false);
}

/// All corners of the triangles that the substitutions change: what leans on them starts at one of these.
std::vector<std::uint32_t> Geomorphs::touched_slots(const ResidentPage& page, std::size_t fan,
                                                    std::uint16_t from, std::uint16_t goal) const {
  const auto children = page.children(page.fans()[fan]);
  std::vector<std::uint32_t> slots;
  for (std::uint16_t i = from; i < goal; ++i) {
    slots.insert(slots.end(), {children[i].from_slot, children[i].to_slot});
    page.for_each_changed(children[i], [&](TriangleHandle t) {
      for (std::uint32_t c = 0; c < 3; ++c) slots.push_back(pool_.corner(t, c));
    });
  }
  std::sort(slots.begin(), slots.end());
  slots.erase(std::unique(slots.begin(), slots.end()), slots.end());
  return slots;
}

void Geomorphs::begin_merge(const ResidentPage& page, std::size_t fan, std::uint16_t goal) {
  Merge m{page.id(), static_cast<std::uint32_t>(fan),
          goal,      false,
          {},        touched_slots(page, fan, page.fans()[fan].applied, goal)};
  for (const std::uint32_t slot : m.leaning) ++leaned_on_[slot];
  const FanState& state = page.fans()[fan];
  const auto children = page.children(state);
  for (std::uint16_t i = state.applied; i < goal; ++i) {
    m.slots.push_back(children[i].from_slot);
    const DrawVertex from = shown(children[i].from_slot);
    blend(children[i].from_slot, children[i].to_slot, from, true);
  }
  merge_of_[key(m.page, m.fan)] = static_cast<std::uint32_t>(merges_.size());
  merges_.push_back(std::move(m));
}

Geomorphs::Merge Geomorphs::take_merge(std::uint32_t index) {
  Merge m = std::move(merges_[index]);
  merge_of_.erase(key(m.page, m.fan));
  if (index + 1 < merges_.size()) {
    merges_[index] = std::move(merges_.back());
    merge_of_[key(merges_[index].page, merges_[index].fan)] = index;
  }
  merges_.pop_back();
  lean_no_more(m.leaning);
  return m;
}

void Geomorphs::lean_no_more(std::span<const std::uint32_t> slots) {
  for (const std::uint32_t slot : slots)
    if (--leaned_on_[slot] == 0) leaned_on_.erase(slot);
}

void Geomorphs::call_off(std::uint32_t merge) {
  for (const std::uint32_t slot : take_merge(merge).slots) {
    const DrawVertex from = shown(slot);
    blend(slot, slot, from, false);
  }
}

void Geomorphs::vanish(const ResidentPage& page, std::size_t fan, std::uint16_t applied, std::uint16_t goal) {
  if (idle()) return;
  if (const auto it = merge_of_.find(key(page.id(), static_cast<std::uint32_t>(fan))); it != merge_of_.end())
    take_merge(it->second);
  const auto children = page.children(page.fans()[fan]);
  for (std::uint16_t i = applied; i < goal; ++i) drop_blend(children[i].from_slot);
}

bool Geomorphs::must_wait(const ResidentPage& page, std::size_t fan, std::uint16_t goal) const {
  if (leaned_on_.empty()) return false;
  const FanState& state = page.fans()[fan];
  const auto children = page.children(state);
  for (std::uint16_t i = state.applied; i < goal; ++i)
    if (leaned_on_.contains(children[i].from_slot)) return true;
  return false;
}

void Geomorphs::postpone(const ResidentPage& page, std::size_t fan, std::uint16_t from, std::uint16_t goal) {
  for (const std::uint32_t slot : touched_slots(page, fan, from, goal)) {
    ++leaned_on_[slot];
    postponed_.push_back(slot);
  }
}

std::vector<Range> Geomorphs::take_restored() {
  std::vector<Range> ranges;
  for (const std::uint32_t slot : std::exchange(restored_, {}))
    if (!blend_of_.contains(slot)) ranges.push_back({slot, 1});
  return ranges;
}

}  // namespace cuesta
