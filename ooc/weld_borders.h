#pragma once
/// Joins open borders that lie within a tolerance of each other, as those of the tiles of one scan do: a
/// stage between distribute and clean, for builds that ask for it.
///
///   find    chunk by chunk: points on open borders, into ranges along a sweep   (border_points.h)
///   sweep   range after range: where each point goes                            (border_sweep.h)
///   move    chunk by chunk: triangles with a corner that goes elsewhere, anew
///
/// The soup stays as it is; what changes lies beside it. Which points go where is a function of the surface
/// and the tolerance, not of chunks, threads or memory.

#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <span>
#include <vector>

#include "ooc/bucket_file.h"
#include "ooc/memory_budget.h"
#include "ooc/space_tree.h"
#include "ooc/triangle_soup.h"

namespace cuesta {

/// No tolerance may be more than this part of the surface's largest extent.
inline constexpr double kMostWeldPart = 1.0 / 64;

/// Triangles that welding has changed, by chunk, and where they were.
class MovedTriangles {
 public:
  std::uint64_t border_points = 0;  ///< different points on open borders
  std::uint64_t points_welded = 0;  ///< of them, those that went to another

  MovedTriangles() = default;
  static Result<MovedTriangles> create(const std::filesystem::path& folder);
  /// Opens what was complete when encode() was called. @error not_found, io, corrupt
  static Result<MovedTriangles> open(const std::filesystem::path& folder, std::span<const std::byte> state);
  std::vector<std::byte> encode() const;
  static void remove(const std::filesystem::path& folder);

  std::uint64_t bytes(std::uint32_t chunk) const { return records_ ? records_->bytes(chunk) : 0; }
  /// The chunk's soup after welding. @param records  as they were (consumed)
  Result<std::vector<std::byte>> apply(std::uint32_t chunk, std::vector<std::byte> records,
                                       const SoupLayout& layout) const;

 private:
  friend class BorderWelder;
  std::unique_ptr<BucketFile> records_;   ///< soup records as they are now, by every chunk that they touch
  std::unique_ptr<BucketFile> ordinals_;  ///< of triangles to be left out, by every chunk that they touched
};

/// What weld_borders() works on.
struct SoupChunks {
  const BucketFile& soup;
  const SpaceTree& tree;
  const SoupLayout& layout;
  Box3<std::int32_t> box;         ///< of all points of it
  std::uint64_t triangles = 0;    ///< about how many it has
  std::uint64_t chunk_bytes = 0;  ///< what working on one chunk takes
};

/// Moves points on open borders to others within `tolerance` of them; what then has two corners at one point
/// is for clean_chunk() to drop. In parallel but for the sweep.
/// @param tolerance  grid steps. Less than 1 joins nothing: points on the grid are farther apart, or one.
/// @param progress   triangles done; false cancels
/// @error out_of_budget (memory for a chunk, for the points within some tolerances of an oblique plane;
/// disk), io,
///        cancelled
/// @cost  about the time that cleaning takes, of borders 2 µs per point; disk: 40 bytes per point on a
/// border, and
///        twice a soup record for each triangle there
Result<MovedTriangles> weld_borders(const SoupChunks& chunks, double tolerance, MemoryBudget& memory,
                                    const std::filesystem::path& folder,
                                    const std::function<bool(std::uint64_t triangles)>& progress);

}  // namespace cuesta
