#pragma once
/// Positions of the postings of a lattice, window by window; and where on the lattice a position is.

#include <span>

#include "ooc/vec.h"
#include "terrain/crs.h"
#include "terrain/frame.h"
#include "terrain/height_raster.h"

namespace cuesta {

/// A place on a lattice, between postings too.
struct LatticePoint {
  double column = 0, row = 0;
};

/// Const calls are concurrent.
class PostingPositions {
 public:
  PostingPositions(const Frame& frame, const Crs& crs, const PostingMap& map);

  /// Positions in the frame, metres; NaN where the height is NaN or the projection has no such place.
  /// @param window     may leave the lattice: its map goes on
  /// @param heights_m  above what the frame's heights are, row by row
  /// @cost of an unrotated geographic lattice on the globe, or a plane's own lattice, 3 ns a posting; else
  /// that of
  ///       Frame::position_m(). Angles are taken once a row and a column.
  void of(std::int64_t first_column, std::int64_t first_row, std::uint64_t width, std::uint64_t height,
          std::span<const float> heights_m, std::span<Vec3d> positions_m) const;

  /// The vertical projection of a position onto the lattice. NaN outside of the projection; columns of
  /// geographic lattices are those from `near_column` - half a turn on.
  LatticePoint lattice_point(Vec3d position_m, double near_column) const;

  /// Whether straight lines of the frame are straight on the lattice.
  bool is_straight() const { return is_plane_; }
  /// Columns that make 360°, 0 if x is no longitude.
  double columns_around() const { return columns_around_; }

 private:
  void of_globe(std::int64_t first_column, std::int64_t first_row, std::uint64_t width, std::uint64_t height,
                std::span<const float> heights_m, std::span<Vec3d> positions_m) const;

  Frame frame_;
  Crs crs_;
  PostingMap map_;
  bool is_plane_ = false;  // the frame's own
  bool is_globe_ = false;  // geographic and axis-aligned, in a frame that is not projected
  double columns_around_ = 0;
};

}  // namespace cuesta
