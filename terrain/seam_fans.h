#pragma once
/// Which vertices a posting of seams is: where voids touch in it, one for each fan of its triangles.

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "terrain/lattice_patch.h"
#include "terrain/mosaic.h"

namespace cuesta {

/// The fans of the lattice's own cells at a posting, as LatticePatch numbers them, with the other corners of
/// their triangles.
struct CellFans {
  std::array<std::vector<PostingRef>, LatticePatch::most_fans> others;
};

/// The triangles of cells and seams around postings, joined by the edges that they share. 40 bytes for each
/// posting that is several vertices, 4 a seam.
class SeamFans {
 public:
  /// A posting, and the fan of each of its cell fans.
  struct Split {
    PostingRef at;
    std::uint32_t count = 0;
    std::array<std::uint8_t, LatticePatch::most_fans> of_cells{};
  };

  /// @param corners  of each seam triangle, by the postings that stand for them
  explicit SeamFans(std::span<const SeamTriangle> corners);

  /// Postings of seams, each once.
  std::span<const PostingRef> postings() const { return postings_; }
  bool contains(const PostingRef& at) const;
  /// Joins the fans of postings()[i].
  /// @post  of more than most_fans the last ones have one number
  Split split(std::size_t i, const CellFans& cells, std::span<const SeamTriangle> corners);
  /// Keeps those with several fans. @param splits  of all postings, in their order
  void keep(std::vector<Split> splits);

  /// How many vertices a posting of seams is.
  std::uint32_t count(const PostingRef& at) const;
  /// 0 of cell fan 0.
  std::uint32_t of_cells(const PostingRef& at, std::uint32_t cell_fan) const;
  std::uint32_t of_seam(std::size_t seam, std::size_t corner) const { return fans_[seam][corner]; }

 private:
  const Split* find(const PostingRef& at) const;

  std::vector<PostingRef> postings_;                // sorted
  std::vector<std::uint64_t> first_use_;            // of each posting, and of one after the last
  std::vector<std::array<std::uint32_t, 2>> uses_;  // seam and corner
  std::vector<std::array<std::uint8_t, 3>> fans_;   // of each seam's corners
  std::vector<Split> splits_;                       // sorted
};

}  // namespace cuesta
