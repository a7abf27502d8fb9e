#include "hierarchy/partition.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>
#include <set>

#include "tests/hierarchy/seam_groups.h"

namespace cuesta {
namespace {

std::vector<Vec3f> random_centres(std::size_t n, std::uint32_t seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<float> at(0, 1000);
  std::vector<Vec3f> out(n);
  for (Vec3f& c : out) c = {at(random), at(random), at(random) * 0.1f};
  return out;
}

TEST(Partition, balanced_and_complete) {
  for (const std::size_t n : {1u, 7u, 100u, 101u, 1000u, 4097u})
    for (std::uint32_t round = 0; round < 6; ++round) {
      const auto centres = random_centres(n, 1);
      const Partition p = partition_cells(centres, 100, round);
      std::set<std::uint32_t> seen(p.order.begin(), p.order.end());
      EXPECT_EQ(seen.size(), n);
      EXPECT_EQ(p.cell_count(), (n + 99) / 100);
      std::size_t least = n, most = 0;
      for (std::uint32_t c = 0; c < p.cell_count(); ++c) {
        least = std::min(least, p.cell(c).size());
        most = std::max(most, p.cell(c).size());
        EXPECT_TRUE(std::is_sorted(p.cell(c).begin(), p.cell(c).end()));
      }
      EXPECT_LE(most, 100u);
      EXPECT_LE(most - least, 1u) << n << " triangles, round " << round;
    }
}

TEST(Partition, deterministic_also_with_equal_centres) {
  std::vector<Vec3f> centres(1000, Vec3f{1, 2, 3});
  const Partition a = partition_cells(centres, 64, 1), b = partition_cells(centres, 64, 1);
  EXPECT_EQ(a.order, b.order);
  EXPECT_EQ(a.begin, b.begin);
}

TEST(Partition, next_round_cuts_elsewhere) {
  const auto centres = random_centres(4000, 2);
  const Partition a = partition_cells(centres, 500, 0), b = partition_cells(centres, 500, 1);
  std::vector<std::uint32_t> cell(4000);
  for (std::uint32_t c = 0; c < a.cell_count(); ++c)
    for (std::uint32_t t : a.cell(c)) cell[t] = c;
  std::size_t mixed = 0;
  for (std::uint32_t c = 0; c < b.cell_count(); ++c) {
    std::set<std::uint32_t> sources;
    for (std::uint32_t t : b.cell(c)) sources.insert(cell[t]);
    mixed += sources.size() > 1;
  }
  EXPECT_EQ(mixed, b.cell_count());
}

TEST(Partition, nothing) {
  EXPECT_EQ(partition_cells({}, 100, 0).cell_count(), 0u);
}

//   1---3     two triangles with vertices of their own along the edge 1-2 (seam), and one that touches point
//   0 only | \ | 0---2
TEST(SeamGroups, joins_across_an_edge_and_not_at_a_point) {
  const std::vector<Vec3i> at{{0, 0, 0}, {0, 1, 0}, {1, 0, 0},  {1, 1, 0}, {0, 1, 0},
                              {1, 0, 0}, {0, 0, 0}, {-1, 0, 0}, {0, -1, 0}};
  const std::vector<std::array<std::uint32_t, 3>> triangles{{0, 2, 1}, {3, 4, 5}, {6, 7, 8}};
  EXPECT_EQ(seam_groups(at, triangles), (std::vector<std::uint32_t>{0, 1, 2, 3, 1, 2, 6, 7, 8}));
}

TEST(SeamGroups, three_sheets_at_an_edge_stay_apart) {
  const std::vector<Vec3i> at{{0, 0, 0},  {1, 0, 0}, {0, 1, 0}, {0, 0, 0}, {1, 0, 0},
                              {0, -1, 0}, {0, 0, 0}, {1, 0, 0}, {0, 0, 1}};
  const std::vector<std::array<std::uint32_t, 3>> triangles{{0, 1, 2}, {4, 3, 5}, {6, 7, 8}};
  EXPECT_EQ(seam_groups(at, triangles), (std::vector<std::uint32_t>{0, 1, 2, 3, 4, 5, 6, 7, 8}));
}

}  // namespace
}  // namespace cuesta
