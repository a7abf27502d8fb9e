#pragma once
/// The full-resolution surface of a .cuesta file, met by line segments, page by page.
///
/// Every triangle of the original surface is in exactly one page of round 0: those whose bound a segment
/// misses are not read. Threads: one at a time. Memory: at most 64 pages' triangles and positions, 0.6 MiB
/// each with the usual cells, and 64 MiB of PagePositions.

#include <array>
#include <cstdint>
#include <list>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "hierarchy/cuesta_file.h"
#include "hierarchy/page_positions.h"

namespace cuesta::sample {

class FinestSurface {
 public:
  /// @param file  outlives this.
  explicit FinestSurface(const CuestaFile& file);

  /// Where the segment meets the surface, in world units; where it does so several times, nearest to `to`.
  /// Vertices have been snapped to the file's grid: a segment that passes outside by no more than
  /// Grid::snap_error(), as one through a posting on the border may, meets the border.
  /// @pre   from != to, finite.
  /// @error of reading a page.
  /// @cost  bounds of all pages of round 0, and every triangle of those it may meet: 0.3 ms a page of the
  /// usual
  ///        size, about 10 ms the first time.
  Result<std::optional<Vec3d>> meet(Vec3d from, Vec3d to);

  std::uint64_t pages_read() const { return pages_read_; }

 private:
  struct Loaded {
    PageId id;
    std::vector<std::array<std::uint32_t, 3>> triangles;
    std::vector<Vec3i> positions;
  };
  Result<const Loaded*> load(PageId id);

  const CuestaFile& file_;
  PagePositions positions_;
  std::vector<PageId> finest_;
  std::list<Loaded> loaded_;  // most recently used first
  std::uint64_t pages_read_ = 0;
};

}  // namespace cuesta::sample
