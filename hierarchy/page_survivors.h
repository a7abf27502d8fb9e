#pragma once
/// What a page of one round leaves to the next: the surviving triangles, with all that the next round's cells
/// need of them. The only data that pass from round to round, beside the facts in the journal (CellFacts)
/// that plan it.

#include <cstddef>
#include <span>
#include <vector>

#include "hierarchy/round_chunk.h"
#include "ooc/result.h"
#include "ooc/space_tree.h"

namespace cuesta {

/// 24 to 40 bytes per vertex; per triangle 36 and its samples, 12 bytes each.
struct PageSurvivors {
  std::vector<VertexId> ids;         ///< ascending
  std::vector<std::uint32_t> wedge;  ///< place of each vertex in its wedge group
  VertexTable vertices;
  std::vector<Triangle> triangles;  ///< of the vertices above; ascending in the page
  std::vector<Birth> births;
  TriangleSamples samples;
};

std::vector<std::byte> encode_survivors(const PageSurvivors& survivors);
/// @error corrupt
Result<PageSurvivors> decode_survivors(std::span<const std::byte> bytes);

/// Takes the triangles whose centres lie in one leaf of a round's tree from the survivors of pages. Corners
/// may lie outside; those are locked, and so are groups that triangles of other leaves use.
class ChunkCollector {
 public:
  ChunkCollector(const SpaceTree& tree, std::uint32_t leaf) : tree_(tree), leaf_(leaf) {}
  /// Call for every page with a vertex or a triangle's centre in the leaf (others do no harm), in ascending
  /// order.
  void add(PageId page, PageSurvivors survivors);
  RoundChunk take();

 private:
  void add_vertex(const PageSurvivors& page, std::uint32_t v, bool inside);

  const SpaceTree& tree_;
  std::uint32_t leaf_;
  RoundChunk out_;  // triangles count the vertices as they came
  std::vector<std::uint8_t> inside_;
  std::vector<VertexId> met_outside_;  // groups inside that triangles of other leaves use
  std::vector<std::uint32_t> number_;  // of a page's vertices, scratch
};

}  // namespace cuesta
