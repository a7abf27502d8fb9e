#pragma once
/// Extraction that remembers: the triangles of one TOM at resolutions that mostly differ little from the
/// last.

#include <cstdint>
#include <span>
#include <vector>

#include "hierarchy/tom.h"

namespace cuesta {

/// Keeps the corners as they are at a rung of a ladder of resolutions, not far above the one asked for: from
/// there chains are short, and one table of the vertices in between resolves them. Moving on to the next rung
/// down starts from this one, up from the TOM.
/// Memory: 12 bytes per triangle and 4 per vertex of the rung, so it falls with the resolution in use.
/// Threads: one at a time; many cursors can be on one TOM.
class TomCursor {
 public:
  /// Resolutions of neighbouring rungs are as 2 to the fourth root of 2: at most 16 % of the vertices of a
  /// rung are above what is asked for.
  static constexpr int rungs_per_octave = 4;

  /// @param tom  outlives the cursor
  explicit TomCursor(const Tom& tom) : tom_(tom) {}

  /// As extract_triangles().
  /// @cost 1 table look-up per corner. On another rung: one more pass, upwards over whole chains.
  std::uint32_t extract(Resolution n, std::span<Triangle> out);

  /// How many triangles extract() would write.
  std::uint32_t count(Resolution n);

  /// Calls visit(Triangle) for each of them instead; as fast as reading an index buffer and a look-up for
  /// each corner.
  template <class Visit>
  void visit(Resolution n, const Visit& visit) {
    const View view = prepare(n);
    if (view.table == nullptr) {
      for (const Triangle& t : view.corners) visit(t);
    } else {
      for (const Triangle& t : view.corners)
        visit(Triangle{view.table[t[0]], view.table[t[1]], view.table[t[2]]});
    }
  }

  /// Substitutions that the last extract() or visit() followed, all corners together (figure 6 of the paper);
  /// without those of a move to another rung.
  std::uint32_t followed() const { return table_for_ == 0 ? 0 : rung_ - table_for_; }

 private:
  /// The triangles as they are at the rung, and where their corners have gone; nullptr if nowhere.
  struct View {
    std::span<const Triangle> corners;
    const std::uint32_t* table;
  };
  View prepare(Resolution n);
  Resolution rung_above(Resolution n) const;
  void move_to(Resolution rung);
  void fill_table(Resolution n);

  const Tom& tom_;
  Resolution rung_ = 0;               // 0: none yet
  std::vector<Triangle> corners_;     // at the rung
  std::vector<std::uint32_t> table_;  // per vertex of the rung, its active ancestor at table_for_
  Resolution table_for_ = 0;
  Resolution counted_ = 0;  // resolution of count_
  std::uint32_t count_ = 0;
};

}  // namespace cuesta
