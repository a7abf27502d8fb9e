#pragma once
/// A right-triangulated irregular network: the hierarchy of bisected right triangles, cut where it is good
/// enough. Source: Evans, Kirkpatrick, Townsend, "Right-triangulated irregular networks", Algorithmica 30,
/// 2001; the restricted hierarchy as in Lindstrom, Pascucci, "Visualization of large terrains made easy",
/// 2001. Deviation from the quick variants (martini, which looks at midpoints only and so exceeds its bound):
/// a triangle's error is the largest vertical distance of all postings under it. Errors are saturated: that
/// of a midpoint is at least those of both triangles that it splits and of the midpoints below, so the cut
/// has no T-junctions.

#include "tools/baselines/height_grid.h"

namespace cuesta::baselines {

class RightTriangles {
 public:
  /// Computes the error of every midpoint.
  /// @pre columns == rows == 2^k + 1 ≤ most_columns_or_rows, heights finite; the heights stay where they are.
  /// @cost 2 k passes over the postings; 4 bytes each. One thread.
  explicit RightTriangles(const HeightGrid& grid);

  /// Triangles that cover the grid, with every posting within `most_error_m` of them vertically.
  std::vector<GridTriangle> cut(double most_error_m) const;

  static bool takes(std::uint32_t columns, std::uint32_t rows);

 private:
  void saturate(GridPoint a, GridPoint b, GridPoint c, int level);
  void refine(GridPoint a, GridPoint b, GridPoint c, double most_error_m,
              std::vector<GridTriangle>& out) const;
  std::uint32_t posting(GridPoint p) const;

  HeightGrid grid_;
  std::vector<float>
      error_m_;  ///< of the midpoint at each posting, rounded up; 0: no triangle is split there
};

}  // namespace cuesta::baselines
