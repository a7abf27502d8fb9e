#pragma once
/// A part of the surface at the start of a round that fits in memory, and the cells it is cut into.

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "hierarchy/cell_mesh.h"
#include "hierarchy/page.h"
#include "hierarchy/partition.h"
#include "ooc/input_surface.h"

namespace cuesta {

/// Which survivor of which page a triangle was; pages in ascending order, survivors too.
struct TriangleOrigin {
  PageId page;
  std::uint32_t survivor;
};

/// Vertices that a page of the round before has left, in its order.
struct SurvivorIds {
  PageId page = 0;
  std::vector<VertexId> ids;  ///< ascending
};

/// All local orders are by VertexId. Per vertex 25 to 41 bytes; 12 bytes per triangle in round 0, then 44 and
/// its samples, 12 bytes each.
struct RoundChunk : SurfaceChunk {
  std::vector<Birth> births;  ///< empty in round 0, as the following
  TriangleSamples samples;
  std::vector<TriangleOrigin> origins;
  std::vector<SurvivorIds> sources;  ///< ascending: the pages that triangles come from

  VertexId group_id(std::uint32_t v) const { return ids[v] - wedge[v]; }
};

/// A cell as the kernel wants it, and the way back to the chunk.
struct Cell {
  CellMesh mesh;
  std::vector<std::uint32_t> vertices;  ///< number in the chunk of each local vertex, ascending
  std::vector<PageSource> sources;
};

/// Centre of each triangle, grid units.
std::vector<Vec3f> triangle_centres(std::span<const Triangle> triangles, std::span<const Vec3i> positions);

/// Copies the cells of a chunk out. Copying is const and may run concurrently.
class RoundCells {
 public:
  /// @pre the chunk outlives this
  RoundCells(const RoundChunk& chunk, Partition partition);
  std::uint32_t cell_count() const { return partition_.cell_count(); }
  Cell cell(std::uint32_t c) const;

 private:
  std::vector<PageSource> sources_of(std::span<const std::uint32_t> triangles,
                                     std::span<const std::uint32_t> vertices) const;
  const RoundChunk& chunk_;
  Partition partition_;
  std::vector<std::uint32_t> group_;  ///< per vertex: the first of its wedge group that is in the chunk
  std::vector<std::uint8_t> locked_;  ///< per group: its star is not wholly inside one cell
};

}  // namespace cuesta
