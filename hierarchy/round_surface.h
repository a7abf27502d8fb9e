#pragma once
/// The whole surface at the start of a round, in global vertex numbers, and the cells it is cut into.

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "hierarchy/cell_mesh.h"
#include "hierarchy/page.h"
#include "hierarchy/partition.h"
#include "ooc/grid_mesh.h"

namespace cuesta {

/// Which survivor of which page a triangle was; pages in ascending order, survivors too.
struct TriangleOrigin {
  PageId page;
  std::uint32_t survivor;
};

/// 12 bytes per triangle of the input in round 0; then 44 and its samples, 12 bytes each.
struct RoundSurface {
  std::uint32_t round = 0;
  std::vector<std::array<std::uint32_t, 3>> triangles;  ///< global vertex numbers
  std::vector<Birth> births;                            ///< empty in round 0
  TriangleSamples samples;                              ///< empty in round 0
  std::vector<TriangleOrigin> origins;                  ///< empty in round 0
  PageId first_page = 0;                                ///< of the round before
  std::vector<std::vector<std::uint32_t>>
      survivor_vertices;  ///< per page of the round before: ascending, global
};

/// A cell as the kernel wants it, and the way back to global numbers.
struct Cell {
  CellMesh mesh;
  std::vector<std::uint32_t> vertices;  ///< global number of each local vertex, ascending
  std::vector<PageSource> sources;
};

/// Centre of each triangle, grid units.
std::vector<Vec3f> triangle_centres(std::span<const std::array<std::uint32_t, 3>> triangles,
                                    const GridMesh& mesh);

/// Copies the cells of a surface out. Copying is const and may run concurrently.
class RoundCells {
 public:
  RoundCells(const RoundSurface& surface, const GridMesh& mesh, Partition partition);
  std::uint32_t cell_count() const { return partition_.cell_count(); }
  Cell cell(std::uint32_t c) const;
  /// Pages of the round before that cell c has triangles of, ascending.
  std::vector<PageId> source_pages(std::uint32_t c) const;

 private:
  std::vector<PageSource> sources_of(std::span<const std::uint32_t> triangles,
                                     std::span<const std::uint32_t> vertices) const;
  const RoundSurface& surface_;
  const GridMesh& mesh_;
  Partition partition_;
  std::vector<std::uint8_t> shared_;  ///< per wedge group: used by more than one cell
};

}  // namespace cuesta
