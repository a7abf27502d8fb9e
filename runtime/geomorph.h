#pragma once
/// Timed blends of the fine path: a vertex that a split brings back grows out of its substitute; one that is
/// about to be substituted first moves there, and its substitution is applied when it has arrived. The cut
/// itself is made of whole substitutions: decisions are made for it, never for a blend under way. Source:
/// Bouvier, Gobbetti, "TOM: Totally Ordered Mesh", 2001, §3.4; that merges wait for their blend is ours.

#include <cstdint>
#include <span>
#include <unordered_map>
#include <vector>

#include "runtime/draw_list.h"
#include "runtime/geometry_pool.h"
#include "runtime/resident_page.h"

namespace cuesta {

/// Threads: one.
class Geomorphs {
 public:
  /// More are not blended at the same time; others change at once.
  static constexpr std::size_t most_vertices = 2048;

  explicit Geomorphs(const GeometryPool& pool) : pool_(pool) {}
  /// 0: no blends; those under way end with the next update().
  void set_duration_ms(double ms) { duration_ms_ = ms; }
  double duration_ms() const { return duration_ms_; }
  bool on() const { return duration_ms_ > 0; }
  bool has_room() const { return blends_.size() < most_vertices; }

  /// A merge that waits for its blend.
  struct Merge {
    PageId page;
    std::uint32_t fan;
    std::uint16_t goal;
    bool due = false;  ///< its blend is over
    std::vector<std::uint32_t> slots, leaning;
  };

  /// Moves all blends on to `now_ms`.
  void update(double now_ms);

  /// Substitutions [goal, applied) of the fan have just been undone: their vertices grow from their
  /// substitutes.
  void grow(const ResidentPage& page, std::size_t fan, std::uint16_t goal, std::uint16_t applied);
  /// The fan's substitutions up to `goal` begin to blend; they are to be applied when they are due.
  void begin_merge(const ResidentPage& page, std::size_t fan, std::uint16_t goal);
  bool merging(PageId page, std::uint32_t fan) const { return merge_of_.contains(key(page, fan)); }
  std::span<const Merge> merges() const { return merges_; }
  /// The merge with this index is no longer wanted: its vertices move back.
  void call_off(std::uint32_t merge);
  /// Substitutions [applied, goal) of the fan have just been applied, after a blend or at once.
  void vanish(const ResidentPage& page, std::size_t fan, std::uint16_t applied, std::uint16_t goal);

  /// True if a substitution of [applied, goal) leans on a merge that waits, or on what was told by
  /// postpone(). A merge that has begun leans on neither: what it leans on was applied when it began, and it
  /// is called off before any of that is undone, for its sse is not less.
  bool must_wait(const ResidentPage& page, std::size_t fan, std::uint16_t goal) const;
  /// So does what leans on substitutions [from, goal) of this fan, until update().
  void postpone(const ResidentPage& page, std::size_t fan, std::uint16_t from, std::uint16_t goal);

  bool idle() const { return blends_.empty() && merges_.empty(); }
  /// Vertices as they are to be drawn in this frame instead of what the pool says.
  std::span<const MorphedVertex> morphed();
  std::size_t vertices() const { return blends_.size(); }
  /// Slots that are as the pool says again, once for each.
  std::vector<Range> take_restored();

 private:
  struct Blend {
    std::uint32_t slot, to_slot;  // to_slot == slot: back to what it is
    DrawVertex from, now;
    double start_ms;
    bool merge;
  };
  static std::uint64_t key(PageId page, std::uint32_t fan) { return std::uint64_t{page} << 32 | fan; }
  const DrawVertex& shown(std::uint32_t slot) const;
  void blend(std::uint32_t slot, std::uint32_t to_slot, const DrawVertex& from, bool merge);
  void drop_blend(std::uint32_t slot);
  Merge take_merge(std::uint32_t index);
  void lean_no_more(std::span<const std::uint32_t> slots);
  std::vector<std::uint32_t> touched_slots(const ResidentPage& page, std::size_t fan, std::uint16_t from,
                                           std::uint16_t goal) const;

  const GeometryPool& pool_;
  double duration_ms_ = 0, now_ms_ = 0;
  std::vector<Blend> blends_;
  std::unordered_map<std::uint32_t, std::uint32_t> blend_of_;  // slot → index
  std::vector<Merge> merges_;
  std::unordered_map<std::uint64_t, std::uint32_t> merge_of_;   // key() → index
  std::unordered_map<std::uint32_t, std::uint32_t> leaned_on_;  // slot → merges that change a triangle at it
  std::vector<std::uint32_t> postponed_;
  std::vector<MorphedVertex> morphed_;
  std::vector<std::uint32_t> restored_;
};

}  // namespace cuesta
