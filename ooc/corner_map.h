#pragma once
/// Which (position, texture coordinate, normal) triples a face file has used lately, each with the number of
/// its vertex.

#include <algorithm>
#include <cstdint>
#include <vector>

#include "ooc/read_job.h"

namespace cuesta {

/// Open addressing, at most half full: 32 to 64 bytes per triple, half as much again while it grows. It grows
/// while `keep_free` bytes of the budget stay free; when it is full after that it forgets all triples and
/// goes on: what is used again later becomes another vertex with the same values. So do triples with a number
/// of 2^32 - 1 or more, as slots hold 32 bits. Nothing is ever refused.
class CornerMap {
 public:
  struct Key {
    std::uint64_t v, vt, vn;  ///< vt and vn may be 2^64 - 1: none
  };
  struct Found {
    std::uint64_t index;
    bool is_new;
  };

  CornerMap(ReadBudget& budget, std::uint64_t keep_free) : budget_(budget), keep_free_(keep_free) {}
  ~CornerMap() { budget_.release(slots_.size() * sizeof(Slot)); }
  CornerMap(const CornerMap&) = delete;
  CornerMap& operator=(const CornerMap&) = delete;

  /// The vertex that the triple has, or `next`, which becomes its vertex.
  Found find_or_add(const Key& key, std::uint64_t next) {
    if (is_large(key.v) || is_large(key.vt) || is_large(key.vn) || is_large(next)) return {next, true};
    const Slot wanted{static_cast<std::uint32_t>(key.v), static_cast<std::uint32_t>(key.vt),
                      static_cast<std::uint32_t>(key.vn), static_cast<std::uint32_t>(next)};
    Slot* slot = slots_.empty() ? nullptr : &place(wanted);
    if (slot && slot->index != empty) return {slot->index, false};
    if (2 * (entries_ + 1) > slots_.size()) {
      if (!make_room()) return {next, true};
      slot = &place(wanted);
    }
    *slot = wanted;
    ++entries_;
    return {next, true};
  }

 private:
  static constexpr std::uint32_t empty = 0xffff'ffff;
  struct Slot {
    std::uint32_t v = 0, vt = 0, vn = 0, index = empty;
  };
  static bool is_large(std::uint64_t i) { return i >= 0xffff'ffff && i != ~std::uint64_t{0}; }

  static std::uint64_t hash(const Slot& s) {
    std::uint64_t h = (std::uint64_t{s.v} << 32 | s.vt) * 0x9e37'79b9'7f4a'7c15;
    h = (h ^ (h >> 29) ^ s.vn) * 0xbf58'476d'1ce4'e5b9;
    h = (h ^ (h >> 32)) * 0x94d0'49bb'1331'11eb;
    return h ^ (h >> 29);
  }
  Slot& place(const Slot& wanted) {
    const std::size_t mask = slots_.size() - 1;
    for (std::size_t i = hash(wanted) & mask;; i = (i + 1) & mask) {
      Slot& s = slots_[i];
      if (s.index == empty || (s.v == wanted.v && s.vt == wanted.vt && s.vn == wanted.vn)) return s;
    }
  }
  /// Grows or forgets; false if there is no room for a table at all.
  bool make_room() {
    const std::size_t size = slots_.empty() ? 1024 : 2 * slots_.size();
    if (budget_.left() < keep_free_ + size * sizeof(Slot) ||
        !budget_.charge(size, sizeof(Slot), "entries of the corner table")) {
      std::fill(slots_.begin(), slots_.end(), Slot{});
      entries_ = 0;
      return !slots_.empty();
    }
    std::vector<Slot> old(size);
    old.swap(slots_);
    for (const Slot& s : old) {
      if (s.index != empty) place(s) = s;
    }
    budget_.release(old.size() * sizeof(Slot));
    return true;
  }

  ReadBudget& budget_;
  std::uint64_t keep_free_;
  std::vector<Slot> slots_;
  std::uint64_t entries_ = 0;
};

}  // namespace cuesta
