#include "tools/baselines/greedy_delaunay.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <set>

#include "tests/baselines/grids.h"
#include "tests/shared_data.h"

namespace cuesta::test {
namespace {

using baselines::greedy_delaunay;

/// No posting that is a corner lies strictly inside a circumcircle: all against all.
bool is_delaunay(const HeightGrid& grid, const std::vector<GridTriangle>& triangles) {
  std::set<std::uint32_t> corners;
  for (const auto& t : triangles) corners.insert(t.begin(), t.end());
  for (const auto& [a, b, c] : triangles)
    for (const std::uint32_t p : corners) {
      const auto x = [&](std::uint32_t q) { return double(q % grid.columns) - double(p % grid.columns); };
      const auto y = [&](std::uint32_t q) { return double(p / grid.columns) - double(q / grid.columns); };
      const auto lift = [&](std::uint32_t q) { return x(q) * x(q) + y(q) * y(q); };
      const double inside = lift(a) * (x(b) * y(c) - x(c) * y(b)) + lift(b) * (x(c) * y(a) - x(a) * y(c)) +
                            lift(c) * (x(a) * y(b) - x(b) * y(a));
      if (inside > 0) return false;
    }
  return true;
}

TEST(WorstPosting, is_the_farthest_from_the_plane) {
  // 0 0 0     The plane over the upper right half is 0 but for the corner's 4: posting (1, 1) is on 2, (2, 1)
  // on 2; . 5 -1    of 3 and -3 the first in reading order counts. . . 4
  Field field = flat(3, 3);
  field.at(1, 1) = 5;
  field.at(2, 1) = -1;
  field.at(2, 2) = 4;
  const auto worst = baselines::worst_posting(field.grid(), {0, 0}, {2, 0}, {2, 2});
  EXPECT_EQ(worst.error_m, 3);
  EXPECT_EQ(worst.at, (baselines::GridPoint{1, 1}));
}

TEST(GreedyDelaunay, a_plane_takes_two_triangles) {
  Field field = flat(9, 5);
  for (std::uint32_t r = 0; r < 5; ++r)
    for (std::uint32_t c = 0; c < 9; ++c) field.at(c, r) = static_cast<float>(3 * c + 7 * r);
  EXPECT_EQ(greedy_delaunay(field.grid(), 0).size(), 2u);
}

TEST(GreedyDelaunay, a_peak_inside_splits_and_one_on_the_border_halves) {
  Field inside = flat(5, 5);
  inside.at(2, 1) = 10;  // off the diagonal: one triangle in three, then a flip
  const auto around = greedy_delaunay(inside.grid(), 9.9);
  EXPECT_EQ(around.size(), 4u);
  EXPECT_TRUE(is_conforming(inside.grid(), around));
  Field border = flat(5, 5);
  border.at(2, 0) = 10;
  EXPECT_EQ(greedy_delaunay(border.grid(), 9.9).size(), 3u);
  EXPECT_EQ(greedy_delaunay(border.grid(), 10).size(), 2u);
  Field diagonal = flat(5, 5);
  diagonal.at(2, 2) = 10;
  EXPECT_EQ(greedy_delaunay(diagonal.grid(), 9.9).size(), 4u);
}

TEST(GreedyDelaunay, every_posting_is_within_the_error) {
  for (const auto& [columns, rows, seed] : {std::array{40u, 57u, 1u}, {2u, 90u, 2u}, {65u, 65u, 3u}}) {
    const Field field = hills(columns, rows, seed);
    std::size_t finer = std::size_t{columns} * rows * 2 + 1;
    for (const double error_m : {0.0, 1.0, 3.5, 20.0}) {
      const auto triangles = greedy_delaunay(field.grid(), error_m);
      EXPECT_LE(largest_error(field.grid(), triangles), error_m + 1e-9) << columns << " " << error_m;
      EXPECT_LT(triangles.size(), finer);
      finer = triangles.size();
    }
  }
}

TEST(GreedyDelaunay, is_delaunay_and_conforming) {
  for (unsigned seed = 1; seed <= 6; ++seed) {
    const Field field = hills(33 + 5 * seed, 29 + 3 * seed, seed);
    const auto triangles = greedy_delaunay(field.grid(), 4);
    ASSERT_GT(triangles.size(), 200u);
    EXPECT_TRUE(is_conforming(field.grid(), triangles)) << seed;
    EXPECT_TRUE(is_delaunay(field.grid(), triangles)) << seed;
  }
}

/// Figures of an independent implementation; ties may be broken otherwise.
TEST(GreedyDelaunay, as_many_triangles_as_are_known_of_real_terrain) {
  CUESTA_NEED_SHARED(path, "dem/everest1025.i16");
  const Field field = load_i16(path, 1025);
  const auto triangles = greedy_delaunay(field.grid(), 50);
  EXPECT_NEAR(static_cast<double>(triangles.size()), 134'231, 0.01 * 134'231);
  EXPECT_LE(largest_error(field.grid(), triangles), 50 + 1e-9);
}

}  // namespace
}  // namespace cuesta::test
