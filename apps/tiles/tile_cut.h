#pragma once
/// Pieces of a .cuesta file's surface, one after the other, under a cache budget: of each only the pages that
/// it needs are resident.

#include <filesystem>
#include <memory>
#include <vector>

#include "apps/tiles/tile_mesh.h"
#include "runtime/cut.h"

namespace cuesta::tiles {

struct TilePiece {
  TileMesh mesh;
  double margin = 0;  ///< how far outside of the borders it reaches at most, grid units
};

class TileCut {
 public:
  /// @error as Cut::open.
  static Result<std::unique_ptr<TileCut>> open(const std::filesystem::path& file, std::uint64_t cache_bytes);

  const Directory& directory() const { return cut_->directory(); }

  /// The surface within `part`: of the file's vertices in it none is farther than `error` from the mesh, and
  /// none farther than `error * border_share` whose triangle reaches over a border. It is cut off outside of
  /// the borders by that much at least, so that it overlaps with a neighbour, whatever error that one has.
  /// @param error  world units, beyond Grid::snap_error(); 0: all but what is flat on the grid.
  /// @error of reading pages; out_of_budget: the piece does not fit the cache.
  /// @cost what changes from the piece before, and O(fans of resident pages).
  Result<TilePiece> piece(const SurfacePart& part, double error, double border_share);
  /// The same before it is cut: the triangles of all pages that reach into the part, coarse ones outside of
  /// it.
  Result<TileMesh> around(const SurfacePart& part, double error, double border_share);

 private:
  explicit TileCut(std::unique_ptr<Cut> cut) : cut_(std::move(cut)) {}
  TileMesh drawn(const SurfacePart& part);

  std::unique_ptr<Cut> cut_;
  std::vector<std::uint32_t> number_;  // of vertex slots in the mesh being made
};

}  // namespace cuesta::tiles
