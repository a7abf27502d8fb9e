#include "tools/baselines/right_triangles.h"

#include <gtest/gtest.h>

#include "tests/baselines/grids.h"
#include "tests/shared_data.h"

namespace cuesta::test {
namespace {

using baselines::RightTriangles;

TEST(RightTriangles, takes_squares_of_a_power_of_two_and_one) {
  EXPECT_TRUE(RightTriangles::takes(2, 2));
  EXPECT_TRUE(RightTriangles::takes(1025, 1025));
  EXPECT_FALSE(RightTriangles::takes(1024, 1024));
  EXPECT_FALSE(RightTriangles::takes(17, 33));
}

TEST(RightTriangles, a_plane_takes_two_triangles) {
  Field field = flat(17, 17);
  for (std::uint32_t r = 0; r < 17; ++r)
    for (std::uint32_t c = 0; c < 17; ++c) field.at(c, r) = static_cast<float>(c) - 3 * static_cast<float>(r);
  EXPECT_EQ(RightTriangles(field.grid()).cut(0).size(), 2u);
}

TEST(RightTriangles, a_peak_in_the_middle_makes_four) {
  Field field = flat(3, 3);
  field.at(1, 1) = 10;
  const RightTriangles tree(field.grid());
  EXPECT_EQ(tree.cut(9.9).size(), 4u);
  EXPECT_EQ(tree.cut(10).size(), 2u);
}

/// What looking at midpoints only misses: all midpoints down to the peak's are exact.
TEST(RightTriangles, a_peak_that_is_no_coarse_midpoint_is_not_missed) {
  Field field = flat(17, 17);
  field.at(3, 7) = 10;
  const auto triangles = RightTriangles(field.grid()).cut(5);
  EXPECT_GT(triangles.size(), 8u);
  EXPECT_LE(largest_error(field.grid(), triangles), 5);
  EXPECT_EQ(RightTriangles(field.grid()).cut(10).size(), 2u);
}

TEST(RightTriangles, every_posting_is_within_the_error_without_t_junctions) {
  for (unsigned seed = 1; seed <= 4; ++seed) {
    const Field field = hills(65, 65, seed);
    const RightTriangles tree(field.grid());
    std::size_t finer = 2 * 64 * 64 + 1;
    for (const double error_m : {0.0, 2.0, 10.0, 40.0, 90.0}) {
      const auto triangles = tree.cut(error_m);
      EXPECT_LE(largest_error(field.grid(), triangles), error_m + 1e-9) << seed << " " << error_m;
      EXPECT_TRUE(is_conforming(field.grid(), triangles)) << seed << " " << error_m;
      EXPECT_LT(triangles.size(), finer);
      finer = triangles.size();
    }
  }
}

/// Figures of an independent implementation.
TEST(RightTriangles, as_many_triangles_as_are_known_of_real_terrain) {
  CUESTA_NEED_SHARED(path, "dem/everest1025.i16");
  const Field field = load_i16(path, 1025);
  const RightTriangles tree(field.grid());
  EXPECT_EQ(tree.cut(5).size(), 1'550'776u);
  EXPECT_EQ(tree.cut(50).size(), 275'238u);
}

}  // namespace
}  // namespace cuesta::test
