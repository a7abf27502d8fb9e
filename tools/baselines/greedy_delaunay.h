#pragma once
/// Greedy insertion: a Delaunay triangulation of a heightfield that takes in the worst posting until none is
/// worse than asked. Source: Garland, Heckbert, "Fast polygonal approximation of terrains and height fields",
/// CMU-CS-95-181, 1995, §4 (algorithm III: a heap of candidates, one for each triangle; only changed
/// triangles are looked at again). Predicates are exact. Postings are taken as square: spacing of columns and
/// rows is the same.

#include "tools/baselines/height_grid.h"

namespace cuesta::baselines {

/// Triangles that cover the grid, Delaunay in the plane, with every posting within `most_error_m` of them
/// vertically; "within" is for the numbers as computed, so the last bits of f64 may differ from it where
/// heights are not integers. Cocircular postings are connected either way; of equal errors the triangle that
/// came first is split first.
/// A posting whose error is just the one asked for stays out; where rounding takes some of those in, as in
/// other implementations, there are up to 1 % more triangles where heights are whole metres.
/// @pre  2 ≤ columns, rows ≤ most_columns_or_rows; heights finite; most_error_m ≥ 0.
/// @cost 1025² at 5 m: about 2 s and 80 bytes per triangle; the same result every time. One thread.
std::vector<GridTriangle> greedy_delaunay(const HeightGrid& grid, double most_error_m);

}  // namespace cuesta::baselines
