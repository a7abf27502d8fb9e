#pragma once
/// Outlines: the edges at which a surface of lattice cells and seams ends.

#include <unordered_set>

#include "terrain/mosaic_field.h"
#include "terrain/posting_runs.h"

namespace cuesta {

/// A part of a layer, columns from `column` on, modulo columns_around where that is not 0.
struct LayerPart {
  std::uint32_t layer = 0;
  std::uint64_t column = 0, row = 0, width = 0, height = 0;
  bool is_closed = false;  ///< its last column lies beside its first
};

/// The surface lies to the left of it, seen from above.
struct OutlineEdge {
  PostingRef from, to;
  bool operator==(const OutlineEdge&) const = default;
};

/// The edges of a surface that have one triangle.
class Outline {
 public:
  /// Adds an edge, or, where the opposite one is there, takes that away.
  void add(const OutlineEdge& edge);
  /// In an order that depends only on which they are.
  std::vector<OutlineEdge> edges() const;

 private:
  struct Hash {
    std::size_t operator()(const OutlineEdge& edge) const;
  };
  std::unordered_set<OutlineEdge, Hash> edges_;
};

/// What was found in a part of a layer.
struct PartPostings {
  PostingRuns with_data;  ///< also where covered; columns are counted from the part's own
  /// With data, not covered, but in no triangle, beside covered ones: between a surface and the rim there may
  /// be only one row of them.
  std::vector<PostingRef> loose;
};

/// Reads a part once, row by row, and adds the edges of its triangles to the outline. What lies beyond the
/// part is taken as without data.
/// @param covered  postings that are not used; columns counted from the part's own.
/// @error of MosaicField::read().
Result<PartPostings> trace(const MosaicField& field, const LayerPart& part, const PostingRuns& covered,
                           Outline& outline);

}  // namespace cuesta
