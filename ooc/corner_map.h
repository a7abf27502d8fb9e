#pragma once
/// Which (position, texture coordinate, normal) triples a face file has used, each with the number of its
/// vertex.

#include <cstdint>
#include <vector>

#include "ooc/read_job.h"

namespace cuesta {

/// Open addressing, at most half full: 16 to 48 bytes per triple with what a growing table needs for a
/// moment.
class CornerMap {
 public:
  struct Key {
    std::uint64_t v, vt, vn;  ///< vt and vn may be 2^64 - 1: none
  };
  struct Found {
    std::uint64_t index;
    bool is_new;
  };

  /// Numbers triples from 0 in the order of their first use.
  /// @error out_of_budget, also from 2^32 - 2 of one kind on.
  Result<Found> find_or_add(const Key& key, ReadBudget& budget) {
    if (is_large(key.v) || is_large(key.vt) || is_large(key.vn) || entries_ == 0xffff'fffe) return too_many();
    if (2 * (entries_ + 1) > slots_.size()) CUESTA_TRY(grow(budget));
    const Slot wanted{static_cast<std::uint32_t>(key.v), static_cast<std::uint32_t>(key.vt),
                      static_cast<std::uint32_t>(key.vn), entries_};
    Slot& slot = place(wanted);
    if (slot.index != empty) return Found{slot.index, false};
    slot = wanted;
    ++entries_;
    return Found{wanted.index, true};
  }

 private:
  static constexpr std::uint32_t empty = 0xffff'ffff;
  struct Slot {
    std::uint32_t v = 0, vt = 0, vn = 0, index = empty;
  };
  static bool is_large(std::uint64_t i) { return i >= 0xffff'ffff && i != ~std::uint64_t{0}; }
  static tl::unexpected<Error> too_many() {
    return fail(ErrorCode::out_of_budget, "", "",
                "more than 2^32 - 2 distinct corners; convert the file to PLY");
  }

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
  Result<void> grow(ReadBudget& budget) {
    const std::size_t size = slots_.empty() ? 1024 : 2 * slots_.size();
    CUESTA_TRY(budget.charge(size, sizeof(Slot), "entries of the corner table"));
    std::vector<Slot> old(size);
    old.swap(slots_);
    for (const Slot& s : old) {
      if (s.index != empty) place(s) = s;
    }
    budget.release(old.size() * sizeof(Slot));
    return {};
  }

  std::vector<Slot> slots_;
  std::uint32_t entries_ = 0;
};

}  // namespace cuesta
