/// Estimates become what is measured over every posting, and stay saturated.

#include "hierarchy/exact_errors.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "hierarchy/simplify_cell.h"

namespace cuesta {
namespace {

/// Answers by a function of the triangle.
class Judge final : public InputSurface {
 public:
  using Distance = float (*)(const std::array<Vec3i, 3>&);
  explicit Judge(Distance distance) : distance_(distance) { vertical.emplace(); }
  std::uint32_t chunk_count() const override { return 0; }
  std::uint64_t triangles_of(std::uint32_t) const override { return 0; }
  Result<SurfaceChunk> chunk(std::uint32_t) const override { return SurfaceChunk{}; }
  Result<void> measure(std::span<const std::array<Vec3i, 3>> corners,
                       std::span<float> distances) const override {
    if (!distance_) return fail(ErrorCode::io, "", "", "cannot be read");
    std::transform(corners.begin(), corners.end(), distances.begin(), distance_);
    return {};
  }

 private:
  Distance distance_;
};

/// n × n postings with a rim that stays; bumps of a few units.
CellMesh bumpy_cell(std::uint32_t n) {
  CellMesh cell;
  cell.vertical.emplace();
  for (std::uint32_t y = 0; y < n; ++y)
    for (std::uint32_t x = 0; x < n; ++x) {
      cell.positions.push_back({int(x * 50), int(y * 50), int((x * 7 + y * 13) % 5)});
      cell.wedge_group.push_back(y * n + x);
      cell.locked.push_back(x == 0 || y == 0 || x + 1 == n || y + 1 == n);
    }
  for (std::uint32_t y = 0; y + 1 < n; ++y)
    for (std::uint32_t x = 0; x + 1 < n; ++x) {
      const std::uint32_t a = y * n + x;
      cell.triangles.push_back({a, a + 1, a + n + 1});
      cell.triangles.push_back({a, a + n + 1, a + n});
    }
  cell.births.resize(cell.triangles.size());
  cell.samples.begin.assign(cell.triangles.size() + 1, 0);
  return cell;
}

struct Simplified {
  CellMesh cell;
  Page page;
  CellSurvivors survivors;

  explicit Simplified(float birth_error = 0) : cell(bumpy_cell(24)) {
    for (std::size_t t = cell.births.size() / 2; t < cell.births.size(); ++t)
      cell.births[t].error = birth_error;
    auto result = simplify_cell(cell, {.target_triangles = 150});
    page.vertex_count = std::uint32_t(cell.positions.size());
    page.triangles = cell.triangles;
    page.script = std::move(result.script);
    survivors = std::move(result.survivors);
  }
  Result<void> judge(const Judge& judge) {
    return make_errors_exact(judge, cell.positions, cell.births, page, survivors);
  }
};

TEST(ExactErrors, what_is_measured_replaces_estimates) {
  for (const float distance : {0.0f, 2.5f, 400.0f}) {
    Simplified s;
    ASSERT_GT(s.page.script.children.size(), 100u);
    static float given;
    given = distance;
    ASSERT_TRUE(s.judge(Judge([](const std::array<Vec3i, 3>&) { return given; })));
    for (const Child& c : s.page.script.children) EXPECT_EQ(c.error, encode_error_up(distance));
    std::size_t reborn = 0;
    for (const Birth& b : s.survivors.births) {
      EXPECT_TRUE(b.error == 0 || b.error == decode_error(encode_error_up(distance))) << b.error;
      reborn += b.error > 0;
    }
    EXPECT_EQ(reborn > 0, distance > 0);
  }
}

/// Only triangles that reach into one corner are far off: what leans on them is, too, and nothing else.
TEST(ExactErrors, are_saturated) {
  Simplified s;
  const auto distance = [](const std::array<Vec3i, 3>& t) {
    const bool hit = std::any_of(t.begin(), t.end(), [](Vec3i p) { return p.x > 900 && p.y > 900; });
    return hit ? 90.0f : 1.0f;
  };
  ASSERT_TRUE(s.judge(Judge(distance)));
  const ErrorCode8 low = encode_error_up(1), high = encode_error_up(90);
  std::size_t highs = 0;
  for (const Fan& fan : s.page.script.fans) {
    ErrorCode8 before = 0;
    for (std::uint32_t c = fan.first_child; c < fan.first_child + fan.child_count; ++c) {
      const ErrorCode8 error = s.page.script.children[c].error;
      EXPECT_GE(error, before);
      EXPECT_TRUE(error == low || error == high);
      highs += error == high;
      before = error;
    }
  }
  EXPECT_GT(highs, 0u);
  EXPECT_LT(highs, s.page.script.children.size());
  // A surviving triangle that is far off was made by a substitution that says so.
  for (std::size_t i = 0; i < s.survivors.triangles.size(); ++i) {
    const auto& corners = s.survivors.corners[i];
    const bool moved = corners != s.cell.triangles[s.survivors.triangles[i]];
    const std::array at{s.cell.positions[corners[0]], s.cell.positions[corners[1]],
                        s.cell.positions[corners[2]]};
    if (moved) {
      EXPECT_GE(s.survivors.births[i].error, distance(at)) << "survivor " << i;
    }
  }
}

TEST(ExactErrors, births_of_earlier_rounds_are_kept) {
  Simplified s(700);
  const auto& errors = s.page.script.children;
  const auto is_old = [](const Child& c) { return c.error >= encode_error_up(700); };
  const auto before = std::count_if(errors.begin(), errors.end(), is_old);
  ASSERT_GT(before, 0);
  ASSERT_TRUE(s.judge(Judge([](const std::array<Vec3i, 3>&) { return 1.0f; })));
  EXPECT_EQ(std::count_if(errors.begin(), errors.end(), is_old), before);
}

TEST(ExactErrors, an_error_of_reading_is_passed_on) {
  Simplified s;
  const auto done = s.judge(Judge(nullptr));
  ASSERT_FALSE(done);
  EXPECT_EQ(done.error().code, ErrorCode::io);
}

}  // namespace
}  // namespace cuesta
