#pragma once
/// Joins triangles with their vertices and sorts them into chunks.

#include <array>
#include <cstdint>
#include <functional>
#include <span>

#include "ooc/bucket_file.h"
#include "ooc/memory_budget.h"
#include "ooc/raw_surface.h"
#include "ooc/space_tree.h"
#include "ooc/survey.h"
#include "ooc/triangle_soup.h"

namespace cuesta {

/// The chunks that have a triangle: its owner first, then the others that a corner lies in.
struct TriangleChunks {
  std::array<std::uint32_t, 4> chunks{};
  std::size_t count = 0;
  std::span<const std::uint32_t> all() const { return std::span(chunks).first(count); }
};
TriangleChunks chunks_of(const std::array<Vec3i, 3>& corners, const SpaceTree& tree);

/// Sets the owner of a triangle, and writes it to all its chunks.
Result<void> put_in_chunks(SoupTriangle& triangle, const SpaceTree& tree, const SoupLayout& layout,
                           BucketFile::Writer& writer);

/// Triangles done; false cancels.
using TriangleProgress = std::function<bool(std::uint64_t triangles_done)>;

/// Puts each triangle of `raw` into the bucket of the leaf of `tree` that its centre lies in (its owner), and
/// into those of the other leaves that its corners lie in. Triangles with a corner that is not finite are
/// left out.
///
/// A triangle whose corners are in one block of vertices is joined when that block is in memory. The corners
/// of the others are joined block by block, and brought together again by their triangle's ordinal: 144 bytes
/// of disk for each such triangle, in `folder`, until that is done.
/// @param tree   over grid positions, in the identity frame
/// @return number of triangles left out
/// @pre    `soup` is new
/// @error out_of_budget (memory for a block; disk), io, cancelled
Result<std::uint64_t> distribute(const RawSurface& raw, const Grid& grid, const SpaceTree& tree,
                                 const SoupLayout& layout, MemoryBudget& memory,
                                 const std::filesystem::path& folder, BucketFile& soup,
                                 const TriangleProgress& progress);

}  // namespace cuesta
