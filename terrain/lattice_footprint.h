#pragma once
/// Which postings of a layer a triangle's verticals may meet.

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "terrain/mosaic.h"
#include "terrain/posting_positions.h"

namespace cuesta {

/// Columns first … last of a row of the layer.
struct LatticeRun {
  std::uint64_t row = 0, first = 0, last = 0;
};

/// Footprints of triangles on one layer. Const calls are concurrent.
class LatticeFootprints {
 public:
  /// @param frame, layer, positions  outlive this; the positions are those of the layer in the frame
  LatticeFootprints(const Frame& frame, const MosaicLayer& layer, const PostingPositions& positions);

  /// Runs that hold every posting whose vertical goes through the triangle, and few others: those within half
  /// a posting, and where a lattice is torn (around a pole, at the rim of a projection) whole rows.
  /// @param corners_m  in the frame. It may be as large as the Earth.
  std::vector<LatticeRun> of(const std::array<Vec3d, 3>& corners_m) const;

 private:
  struct Outline;
  /// Of all postings, with room for heights.
  struct Sphere {
    Vec3d centre_m;
    double radius_m = 0;
  };
  Sphere find_reach() const;
  bool may_reach(const std::array<Vec3d, 3>& corners_m) const;
  bool covers_a_tear(const std::array<Vec3d, 3>& corners_m) const;
  void add_edge(Outline& outline, LatticePoint a, Vec3d a_m, LatticePoint b, Vec3d b_m, int cuts) const;
  double latitude_deg(double row) const;
  bool is_polar(const Outline& outline, std::span<const LatticePoint, 3> corners) const;
  std::vector<LatticeRun> all_columns(double top, double bottom) const;
  std::vector<LatticeRun> filled(const Outline& outline) const;

  const Frame& frame_;
  const MosaicLayer& layer_;
  const PostingPositions& positions_;
  Sphere reach_;
  std::vector<Vec3d> torn_poles_m_;  // where the lattice's system has no place for them
};

}  // namespace cuesta
