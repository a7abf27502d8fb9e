#include "hierarchy/sample_choice.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>

#include "apps/measure/surface_distance.h"
#include "hierarchy/simplify_cell.h"
#include "runtime/extract.h"
#include "tests/hierarchy/surfaces.h"
#include "tests/runtime/open_file.h"

namespace cuesta::test {
namespace {

const std::array<Vec3f, 3> triangle{Vec3f{0, 0, 0}, Vec3f{1000, 0, 0}, Vec3f{0, 1000, 0}};

std::vector<Vec3f> samples_over(std::mt19937& random, std::size_t count) {
  std::vector<Vec3f> samples;
  for (std::size_t i = 0; i < count; ++i) {
    auto x = static_cast<float>(random() % 1000), y = static_cast<float>(random() % 1000);
    if (x + y > 1000) x = 1000 - x, y = 1000 - y;
    samples.push_back({x, y, static_cast<float>(static_cast<int>(random() % 201) - 100)});
  }
  return samples;
}

TEST(SampleChoice, few_are_left_alone) {
  std::mt19937 random(1);
  const auto samples = samples_over(random, 32);
  auto chosen = samples;
  SampleChoice choice;
  EXPECT_EQ(choice.keep(chosen, triangle, 32), 32u);
  EXPECT_EQ(chosen, samples);
}

TEST(SampleChoice, keeps_the_bound_and_the_farthest) {
  std::mt19937 random(2);
  SampleChoice choice;
  for (int i = 0; i < 500; ++i) {
    const auto samples = samples_over(random, 5 + random() % 300);
    auto chosen = samples;
    const std::size_t most = 2 + random() % 64;
    chosen.resize(choice.keep(chosen, triangle, most));
    EXPECT_EQ(chosen.size(), std::min(most, samples.size())) << "seed 2, case " << i;
    const auto nearer = [](Vec3f a, Vec3f b) { return std::abs(a.z) < std::abs(b.z); };
    const Vec3f farthest = *std::max_element(samples.begin(), samples.end(), nearer);
    EXPECT_EQ(std::abs(std::max_element(chosen.begin(), chosen.end(), nearer)->z), std::abs(farthest.z))
        << "seed 2, case " << i;
  }
}

/// Many far samples in one corner do not crowd out those elsewhere.
TEST(SampleChoice, leaves_one_nearby) {
  std::mt19937 random(3);
  std::vector<Vec3f> samples = samples_over(random, 400);
  for (Vec3f& p : samples) p.z /= 100;
  for (int i = 0; i < 200; ++i)
    samples.push_back({static_cast<float>(random() % 50), static_cast<float>(random() % 50), 500});
  auto chosen = samples;
  chosen.resize(SampleChoice().keep(chosen, triangle, 32));
  for (const Vec3f& p : samples) {
    float nearest = 1e9f;
    for (const Vec3f& c : chosen)
      nearest = std::min(nearest, std::max(std::abs(p.x - c.x), std::abs(p.y - c.y)));
    EXPECT_LE(nearest, 450) << p.x << ' ' << p.y;  // parts are 200 wide
  }
}

TEST(SampleChoice, degenerate_triangles_and_equal_samples) {
  std::vector<Vec3f> samples(100, Vec3f{1, 2, 3});
  samples[60] = {50, 60, 70};
  SampleChoice choice;
  ASSERT_EQ(choice.keep(samples, {Vec3f{}, Vec3f{}, Vec3f{}}, 8), 8u);
  EXPECT_EQ(std::count(samples.begin(), samples.begin() + 8, Vec3f{50, 60, 70}), 1);
}

/// A patch whose triangles stand for 100 samples each; simplified, all still have theirs, and no more than
/// allowed leave the cell, the farthest among them.
TEST(Survivors, respect_the_bound_and_keep_the_worst_sample) {
  const int n = 24;
  CellMesh cell;
  for (int y = 0; y <= n; ++y)
    for (int x = 0; x <= n; ++x) {
      cell.positions.push_back({x * 100, y * 100, (x * 37 + y * 61) % 40});
      cell.wedge_group.push_back(static_cast<std::uint32_t>(cell.wedge_group.size()));
      cell.locked.push_back(x == 0 || y == 0 || x == n || y == n);
    }
  const auto at = [](int x, int y) { return static_cast<std::uint32_t>(y * (n + 1) + x); };
  for (int y = 0; y < n; ++y)
    for (int x = 0; x < n; ++x) {
      cell.triangles.push_back({at(x, y), at(x + 1, y), at(x + 1, y + 1)});
      cell.triangles.push_back({at(x, y), at(x + 1, y + 1), at(x, y + 1)});
    }
  cell.births.resize(cell.triangles.size());
  std::mt19937 random(4);
  cell.samples.begin.push_back(0);
  const Vec3i spike{1111, 1233, 3000};
  for (std::size_t t = 0; t < cell.triangles.size(); ++t) {
    const Vec3i corner = cell.positions[cell.triangles[t][0]];
    for (int i = 0; i < 100; ++i) {
      const auto off = [&] { return static_cast<std::int32_t>(random() % 100); };
      cell.samples.points.push_back(corner + Vec3i{off(), off(), off() - 50});
    }
    if (t == 2 * (12 * n + 11)) cell.samples.points.back() = spike;
    cell.samples.begin.push_back(static_cast<std::uint32_t>(cell.samples.points.size()));
  }
  SimplifyOptions options;
  options.target_triangles = static_cast<std::uint32_t>(cell.triangles.size()) / 4;
  const CellSurvivors out = simplify_cell(std::move(cell), options).survivors;
  ASSERT_EQ(out.samples.begin.size(), out.triangles.size() + 1);
  std::size_t full = 0;
  for (std::size_t t = 0; t < out.triangles.size(); ++t) {
    EXPECT_LE(out.samples.begin[t + 1] - out.samples.begin[t], max_triangle_samples);
    full += out.samples.begin[t + 1] - out.samples.begin[t] == max_triangle_samples;
  }
  EXPECT_GT(full, out.triangles.size() / 2);
  EXPECT_EQ(std::count(out.samples.points.begin(), out.samples.points.end(), spike), 1);
}

/// I5 in a deep hierarchy, where most samples have been left out: no vertex of the original lies beyond the
/// bound, margin included, in any uniform cut.
TEST(Survivors, bound_holds_after_many_rounds) {
  TemporaryFolder folder;
  const SurfaceMesh original = bumpy_sphere(100);
  BuildOptions options;
  options.cell_triangles = 256;
  build_file(original, folder / "deep.cuesta", options);
  const auto cut = open_cut(folder / "deep.cuesta");
  ASSERT_TRUE(cut);
  const Directory& d = cut->directory();
  ASSERT_GE(d.pages.back().round, 5u);
  for (const double share : {0.2, 0.05, 0.02, 0.01, 0.005, 0.002}) {
    Budgets budgets;
    budgets.triangles = static_cast<std::uint64_t>(share * static_cast<double>(d.triangles));
    const auto report = cut->settle(ErrorScale::uniform(d.grid), 0, budgets);
    const auto mesh = extract_mesh(cut->draw_list());
    ASSERT_TRUE(mesh);
    const auto measured = measure::vertex_distance(original, measure::make_tree(*mesh));
    EXPECT_LE(measured.percentiles.max, report.achieved + d.grid.snap_error()) << "share " << share;
    EXPECT_GE(measured.percentiles.max, (report.achieved + d.grid.snap_error()) / 1.5) << "share " << share;
  }
}

}  // namespace
}  // namespace cuesta::test
