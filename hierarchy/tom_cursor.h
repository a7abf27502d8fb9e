#pragma once
/// Extraction that remembers: the triangles of one TOM at resolutions that mostly differ little from the
/// last.

#include <cstdint>
#include <span>
#include <vector>

#include "hierarchy/tom.h"
#include "hierarchy/tom_ancestors.h"

namespace cuesta {

/// Keeps the corners as they are at a rung of a ladder of resolutions, not far above the one asked for: from
/// there chains are short, and a table of the vertices in between resolves them. Moving on to the next rung
/// down starts from this one, up from the TOM.
/// Memory: 12 bytes per triangle of the rung, so it falls with the resolution in use, and 4 per vertex
/// between. Threads: one at a time; many cursors can be on one TOM.
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
  std::uint32_t count(Resolution n) {
    prepare(n);
    return count_;
  }

  /// Calls visit(Triangle) for each of them instead; as fast as reading an index buffer and a look-up for
  /// each corner.
  template <class Visit>
  void visit(Resolution n, const Visit& visit) {
    prepare(n);
    if (at_ == rung_) {
      for (const Triangle& t : active()) visit(t);
    } else {
      const AncestorLookup ancestor = ancestors_.lookup();
      for (const Triangle& t : active()) visit(ancestor(t));
    }
  }

  /// Substitutions that the last extract() or visit() followed, all corners together (figure 6 of the paper);
  /// without those of a move to another rung.
  std::uint32_t followed() const { return rung_ - at_; }

 private:
  void prepare(Resolution n);
  void move_to_rung_above(Resolution n);
  std::span<const Triangle> active() const { return std::span(corners_).first(count_); }

  const Tom& tom_;
  Resolution rung_ = 0, lowest_ = 1;  // resolutions that this rung is for; none yet
  std::vector<Triangle> corners_;     // at the rung
  Resolution at_ = 0;                 // what was asked for last
  std::uint32_t count_ = 0;           // triangles there
  TomAncestors ancestors_;            // there, of the rung's vertices
};

}  // namespace cuesta
