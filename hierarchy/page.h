#pragma once
/// A page: a small mesh and the script that simplifies it. The unit of I/O and residency.
///
/// Local numbers are those of the cell's mesh at the start of its round. A vertex is owned by the page whose
/// script removes it or, a wedge that no surviving triangle uses, orphans it (the base page owns what is
/// never removed); a triangle likewise. What survives the script lives in pages of the next round, which list
/// their sources: so no page is ever patched after it is written.

#include <array>
#include <cstdint>
#include <vector>

#include "hierarchy/cell_mesh.h"
#include "ooc/vertex_table.h"

namespace cuesta {

using PageId = std::uint32_t;  ///< index into the file's directory; finer pages have lower numbers

/// The part of a page that came from one page of the round before.
/// Survivors of the source are numbered in its local order, triangles and vertices apart.
struct PageSource {
  PageId page = 0;
  std::uint32_t first_triangle = 0;           ///< local; the run is as long as `triangles`
  std::vector<std::uint32_t> triangles;       ///< ascending survivor numbers in the source
  std::vector<std::uint32_t> vertices;        ///< ascending survivor numbers in the source
  std::vector<std::uint32_t> local_vertices;  ///< what they are here, ascending
};

struct Page {
  std::uint32_t round = 0;
  bool base = false;  ///< the coarsest page: owns its survivors too
  std::uint32_t vertex_count = 0;
  std::vector<std::array<std::uint32_t, 3>> triangles;  ///< smallest_first (triangle_order.h)
  std::vector<std::uint32_t>
      wedge_tails;  ///< ascending: vertices in the wedge group of the vertex before them
  Script script;
  std::vector<std::uint32_t> orphans;  ///< ascending; neither removed nor used by a surviving triangle
  VertexTable owned;                   ///< ascending local order
  std::vector<Vec3i> survivors;  ///< positions of the vertices that coarser pages own, ascending local order
  std::vector<PageSource> sources;
};

/// 1 for each local vertex that the page owns.
std::vector<std::uint8_t> owned_vertices(const Page& page);

/// Positions of all local vertices.   @pre owned and survivors have all of theirs
std::vector<Vec3i> local_positions(const Page& page);

}  // namespace cuesta
