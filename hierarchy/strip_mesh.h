#pragma once
/// Multiresolution strips: a mesh at any resolution as triangle strips, ready to draw.
/// Source: Ramos, Chover, Belmonte, Rebollo, "An approach to improve strip-based multiresolution schemes",
/// WSCG 2004: lStrips are `entries`, lChanges are `writes` and `cuts`, the field next of lVerts is
/// `substitute`; positions stay with the caller. Beyond the paper:
///   - the length of a strip is dynamic (its "future work"): a repetition is cut out of the strip when a
///   substitution
///     makes it, so that drawing copies;
///   - resolutions are in bands, each with strips of its own that were made of its finest mesh. Strips age no
///     more than a band, changes of a band are few, and a leap costs the changes inside its band only.
/// Resolution r: vertices 0 to r - 1 are active, as in a TOM; every v ≥ r is replaced by its first ancestor
/// below r.
/// Memory: 50 to 55 bytes per vertex of a closed surface with the default options (measured).
/// Threads: const calls are concurrent.

#include <cstdint>
#include <span>
#include <vector>

#include "hierarchy/stripify.h"

namespace cuesta {

/// What set_resolution() did.
struct StripChanges {
  std::uint64_t steps = 0;   ///< substitutions and splits
  std::uint64_t writes = 0;  ///< entries that became another vertex
  std::uint64_t cuts = 0;    ///< runs of entries taken out of a strip, or put back
};

class StripMesh {
 public:
  std::uint32_t vertex_count() const { return static_cast<std::uint32_t>(substitute_.size()); }
  /// The coarsest resolution there is.
  std::uint32_t base_resolution() const { return base_resolution_; }
  std::uint32_t resolution() const { return resolution_; }

  /// @pre base_resolution() ≤ resolution ≤ vertex_count().
  /// @cost O(changes between the resolution asked for and the last one in the same band); no allocation.
  StripChanges set_resolution(std::uint32_t resolution);

  /// Writes the strips, each with strip_restart behind it.   @return how many indices that are.
  /// @pre out has index_bound() elements; what is behind those returned is undefined.
  /// @cost O(indices).
  std::size_t write_indices(std::span<std::uint32_t> out) const;
  /// Enough for write_indices() at every resolution.
  std::size_t index_bound() const { return index_bound_; }

  /// Of all arrays; positions not included.
  std::uint64_t bytes() const;

 private:
  friend class StripMeshBuilder;

  enum class CutKind : std::uint32_t { move_head, move_tail, trim_head, trim_tail };
  /// 8 bytes. `where`: for moves the entry of which a repetition follows, else how many entries are trimmed.
  struct Cut {
    static constexpr std::uint32_t largest = (1u << 30) - 1;
    std::uint32_t strip;
    CutKind kind : 2 = CutKind::move_head;
    std::uint32_t where : 30 = 0;
  };
  static_assert(sizeof(Cut) == 8);
  /// The changes of substituting vertex v are those of step vertex_count - 1 - v; they end where the next
  /// begins.
  struct Step {
    std::uint32_t first_write, first_cut;
  };
  struct Live {
    std::uint32_t begin, end;  // in entries_
  };
  /// Resolutions (finest of the next band, finest].
  struct Band {
    std::uint32_t finest;
    std::uint32_t first_strip;
    std::uint32_t live_strips;  // at its resolution; strips that last longer are first
    std::uint32_t resolution;
  };

  std::size_t band_of(std::uint32_t resolution) const;
  void coarsen(Band& band);
  void refine(Band& band);
  void apply(Band& band, Cut cut);
  void undo(Band& band, Cut cut);

  std::vector<std::uint32_t> substitute_;
  std::vector<Band> bands_;             // the finest first
  std::vector<Live> strips_;            // what of each strip is live now
  std::vector<std::uint32_t> entries_;  // of all strips; what is cut off at an end stays there
  std::vector<Step> steps_;             // one more than vertices
  std::vector<std::uint32_t> writes_;   // places in entries_ of the vertex that is substituted
  std::vector<Cut> cuts_;
  std::uint32_t base_resolution_ = 0, resolution_ = 0;
  std::size_t index_bound_ = 0;
  bool skips_when_drawn_ = false;
};

}  // namespace cuesta
