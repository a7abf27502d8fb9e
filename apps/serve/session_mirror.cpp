#include "apps/serve/session_mirror.h"

#include <zstd.h>

#include <algorithm>
#include <cstring>
#include <functional>

#include "apps/serve/session_codec.h"
#include "ooc/byte_stream.h"
#include "ooc/check.h"
#include "runtime/geometry_pool.h"

namespace cuesta::serve {
namespace {

constexpr std::uint32_t block = GeometryPool::block;
constexpr int zstd_level = 1;

bool is_equal(const DrawVertex& a, const DrawVertex& b) {
  return std::memcmp(&a, &b, sizeof a) == 0;
}

void put_slots(ByteWriter& w, std::vector<std::uint32_t>& slots) {
  std::sort(slots.begin(), slots.end());
  w.put_varint(slots.size());
  std::uint32_t next = 0;
  for (const std::uint32_t s : slots) {
    w.put_varint(s + 1 - next);
    next = s + 1;
  }
}

template <class Number>
void put_difference(ByteWriter& w, Number now, Number before) {
  w.put_varint(zigzag(static_cast<std::int64_t>(now) - static_cast<std::int64_t>(before)));
}

}  // namespace

std::uint32_t SessionMirror::Slots::take() {
  if (free_.empty()) return end_++;
  std::pop_heap(free_.begin(), free_.end(), std::greater<>());
  const std::uint32_t slot = free_.back();
  free_.pop_back();
  return slot;
}

void SessionMirror::Slots::give(std::uint32_t slot) {
  free_.push_back(slot);
  std::push_heap(free_.begin(), free_.end(), std::greater<>());
}

std::optional<std::string> SessionMirror::change(const DrawList& list, bool settled, float achieved_px) {
  CUESTA_CHECK(list.morphed.empty());
  find_affected(list);
  compare(list);
  match_moved(list);
  place_added(list);
  for (const auto& [corners, slot] : lost_) {
    release_vertices(vertices_of_slot_[slot]);
    vertices_of_slot_[slot] = {no_vertex, no_vertex, no_vertex};
    triangle_slots_.give(slot);
    removed_.push_back(slot);
    --used_triangles_;
  }
  forget_unused();
  if (removed_.empty() && set_.empty() && !settled) return std::nullopt;
  return message(settled, achieved_px);
}

std::uint64_t SessionMirror::bytes() const {
  const auto taken = [](const auto&... arrays) {
    return (std::uint64_t{0} + ... + (arrays.capacity() * sizeof(arrays[0])));
  };
  return taken(drawn_, drawn_before_, slot_of_place_, vertices_of_slot_, sent_of_pool_, sent_, affected_,
               added_, removed_, set_, new_vertices_, unused_) +
         triangle_slots_.bytes() + vertex_slots_.bytes() + lost_.bucket_count() * sizeof(void*);
}

/// Places whose triangle may be another one than the client has.
void SessionMirror::find_affected(const DrawList& list) {
  const std::size_t places = list.indices.size() / 3;
  drawn_before_.swap(drawn_);
  drawn_.assign(places / block, 0);
  drawn_before_.resize(std::max(drawn_.size(), drawn_before_.size()), 0);
  drawn_.resize(drawn_before_.size(), 0);
  slot_of_place_.resize(std::max(places, slot_of_place_.size()), 0);
  for (const Range& r : list.draws)
    for (std::uint32_t at = r.first / 3, end = (r.first + r.count) / 3; at < end; at += block)
      drawn_[at / block] = static_cast<std::uint16_t>(std::min(block, end - at));
  affected_.clear();
  for (const Range& r : list.changed_indices)
    for (std::uint32_t at = r.first / 3; at < (r.first + r.count) / 3; ++at) affected_.push_back(at);
  for (std::uint32_t b = 0; b < drawn_.size(); ++b) {
    const auto [least, most] = std::minmax(drawn_[b], drawn_before_[b]);
    for (std::uint32_t i = least; i < most; ++i) affected_.push_back(b * block + i);
  }
  std::sort(affected_.begin(), affected_.end());
  affected_.erase(std::unique(affected_.begin(), affected_.end()), affected_.end());
}

/// Fills lost_ and added_.
void SessionMirror::compare(const DrawList& list) {
  lost_.clear();
  added_.clear();
  for (const std::uint32_t place : affected_) {
    const bool is_drawn = place % block < drawn_[place / block];
    std::uint32_t& slot = slot_of_place_[place];
    Corners now{};
    if (is_drawn) std::copy_n(&list.indices[std::size_t{place} * 3], 3, now.begin());
    if (slot > 0) {
      Corners before{};
      for (std::size_t c = 0; c < 3; ++c) before[c] = sent_[vertices_of_slot_[slot - 1][c]].pool_slot;
      if (is_drawn && is_same(list, now, vertices_of_slot_[slot - 1])) continue;
      lost_.emplace(before, slot - 1);
      slot = 0;
    }
    if (is_drawn) added_.push_back(place);
  }
}

/// Whether the pool's triangle `now` is the client's triangle of the vertices `before`.
bool SessionMirror::is_same(const DrawList& list, const Corners& now, const Corners& before) const {
  for (std::size_t c = 0; c < 3; ++c) {
    const Sent& sent = sent_[before[c]];
    if (sent.pool_slot != now[c] || !is_equal(sent.vertex, list.vertices[now[c]])) return false;
  }
  return true;
}

void SessionMirror::match_moved(const DrawList& list) {
  std::erase_if(added_, [&](std::uint32_t place) {
    Corners now{};
    std::copy_n(&list.indices[std::size_t{place} * 3], 3, now.begin());
    const auto at = lost_.find(now);
    if (at == lost_.end() || !is_same(list, now, vertices_of_slot_[at->second])) return false;
    slot_of_place_[place] = at->second + 1;
    lost_.erase(at);
    return true;
  });
}

/// Into the slots of triangles that are lost, first.
void SessionMirror::place_added(const DrawList& list) {
  set_.clear();
  new_vertices_.clear();
  removed_.clear();
  for (const std::uint32_t place : added_) {
    std::uint32_t slot = 0;
    if (lost_.empty()) {
      slot = triangle_slots_.take();
      if (slot >= vertices_of_slot_.size()) vertices_of_slot_.resize(std::size_t{slot} + 1);
      ++used_triangles_;
    } else {
      slot = lost_.begin()->second;
      lost_.erase(lost_.begin());
      release_vertices(vertices_of_slot_[slot]);
    }
    for (std::size_t c = 0; c < 3; ++c)
      vertices_of_slot_[slot][c] = use_vertex(list, list.indices[std::size_t{place} * 3 + c]);
    slot_of_place_[place] = slot + 1;
    set_.push_back(slot);
  }
}

std::uint32_t SessionMirror::use_vertex(const DrawList& list, std::uint32_t pool_slot) {
  if (pool_slot >= sent_of_pool_.size())
    sent_of_pool_.resize(std::max<std::size_t>(list.vertices.size(), pool_slot + 1));
  std::uint32_t& known = sent_of_pool_[pool_slot];
  const DrawVertex& vertex = list.vertices[pool_slot];
  if (known > 0 && is_equal(sent_[known - 1].vertex, vertex)) {
    ++sent_[known - 1].uses;
    return known - 1;
  }
  // A slot of the pool that holds another page's vertex now: whoever used the old one is lost in this step.
  const std::uint32_t slot = vertex_slots_.take();
  if (slot >= sent_.size()) sent_.resize(std::size_t{slot} + 1);
  sent_[slot] = {vertex, pool_slot, 1};
  known = slot + 1;
  new_vertices_.push_back(slot);
  return slot;
}

void SessionMirror::release_vertices(const Corners& vertices) {
  for (const std::uint32_t v : vertices)
    if (--sent_[v].uses == 0) unused_.push_back(v);
}

/// After all others were added: what is used again in the same step keeps its slot.
void SessionMirror::forget_unused() {
  std::sort(unused_.begin(), unused_.end());
  unused_.erase(std::unique(unused_.begin(), unused_.end()), unused_.end());
  for (const std::uint32_t v : unused_) {
    if (sent_[v].uses > 0) continue;
    std::uint32_t& known = sent_of_pool_[sent_[v].pool_slot];
    if (known == v + 1) known = 0;
    vertex_slots_.give(v);
  }
  unused_.clear();
}

std::string SessionMirror::message(bool settled, float achieved_px) {
  ByteWriter body;
  put_slots(body, removed_);
  put_slots(body, new_vertices_);
  DrawVertex before{0, 0, 0, 0, 0, {255, 255, 255, 255}};
  for (const std::uint32_t s : new_vertices_) {
    const DrawVertex& v = sent_[s].vertex;
    put_difference(body, v.x, before.x);
    put_difference(body, v.y, before.y);
    put_difference(body, v.z, before.z);
    if (has_normals_)
      put_difference(body, v.normal_u, before.normal_u), put_difference(body, v.normal_v, before.normal_v);
    if (has_colours_) body.put(v.colour);
    before = v;
  }
  put_slots(body, set_);
  std::uint32_t corner_before = 0;
  for (const std::uint32_t s : set_) {
    const Corners& t = vertices_of_slot_[s];
    put_difference(body, t[0], corner_before);
    put_difference(body, t[1], t[0]);
    put_difference(body, t[2], t[1]);
    corner_before = t[0];
  }
  std::string text = encode(ChangeHead{settled, ++sequence_, used_triangles_, achieved_px,
                                       static_cast<std::uint32_t>(body.size())});
  text.resize(change_head_bytes + ZSTD_compressBound(body.size()));
  const std::size_t packed = ZSTD_compress(text.data() + change_head_bytes, text.size() - change_head_bytes,
                                           body.bytes().data(), body.size(), zstd_level);
  CUESTA_CHECK(!ZSTD_isError(packed));
  text.resize(change_head_bytes + packed);
  return text;
}

}  // namespace cuesta::serve
