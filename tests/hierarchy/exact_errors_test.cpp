/// Estimates become what is measured over every posting, and stay saturated.

#include "hierarchy/exact_errors.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "hierarchy/rim_postings.h"
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
  Result<std::vector<std::optional<std::vector<Vec3i>>>> postings_over(
      std::span<const std::array<Vec3i, 3>> corners, std::size_t) const override {
    return std::vector<std::optional<std::vector<Vec3i>>>(corners.size(), std::vector<Vec3i>{});
  }

 private:
  Distance distance_;
};

/// n × n postings with a rim that stays, or may move but for one side; bumps of a few units.
CellMesh bumpy_cell(std::uint32_t n, bool rim_moves = false) {
  CellMesh cell;
  cell.vertical.emplace();
  for (std::uint32_t y = 0; y < n; ++y)
    for (std::uint32_t x = 0; x < n; ++x) {
      cell.positions.push_back({int(x * 50), int(y * 50), int((x * 7 + y * 13) % 5)});
      cell.wedge_group.push_back(y * n + x);
      cell.locked.push_back(x == 0 || (!rim_moves && (y == 0 || x + 1 == n || y + 1 == n)));
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
  Result<void> judge(const Judge& judge) { return make_errors_exact(judge, cell, page, survivors); }
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

/// The upper rim as an arc: where it moves, it moves inwards.
int arc(int x) {
  return 2 * x * (23 - x);
}

/// A field of heights that has a posting close to each vertex of the upper rim, 90 above it.
class RaisedRim final : public InputSurface {
 public:
  explicit RaisedRim(std::uint32_t n, bool has_too_many = false)
      : last_(50 * (int(n) - 1)), has_too_many_(has_too_many) {
    vertical.emplace();
    box = {{0, 0, 0}, {last_, last_ + 300, 90}};
  }
  std::uint32_t chunk_count() const override { return 0; }
  std::uint64_t triangles_of(std::uint32_t) const override { return 0; }
  Result<SurfaceChunk> chunk(std::uint32_t) const override { return SurfaceChunk{}; }
  Result<void> measure(std::span<const std::array<Vec3i, 3>>, std::span<float> distances) const override {
    std::fill(distances.begin(), distances.end(), 0.0f);
    return {};
  }
  Result<std::vector<std::optional<std::vector<Vec3i>>>> postings_over(
      std::span<const std::array<Vec3i, 3>> corners, std::size_t most) const override {
    EXPECT_EQ(most, most_beside);
    std::vector<std::optional<std::vector<Vec3i>>> out(corners.size());
    if (has_too_many_) return out;
    for (auto& postings : out) postings.emplace();
    for (std::size_t i = 0; i < corners.size(); ++i)
      for (int x = 1; x < last_ / 50; ++x)
        if (const Vec3i p{50 * x, last_ + arc(x) - 1, 90}; covers(corners[i], p)) out[i]->push_back(p);
    return out;
  }

 private:
  static bool covers(const std::array<Vec3i, 3>& t, Vec3i p) {
    const auto left = [&](Vec3i a, Vec3i b) {
      return std::int64_t{b.x - a.x} * (p.y - a.y) - std::int64_t{b.y - a.y} * (p.x - a.x) >= 0;
    };
    return left(t[0], t[1]) && left(t[1], t[2]) && left(t[2], t[0]);
  }
  int last_;
  bool has_too_many_;
};

/// A cell with the arc, simplified without a look at what its rim leaves behind.
struct SimplifiedArc {
  static constexpr std::uint32_t n = 24;
  CellMesh cell = bumpy_cell(n, true);
  Page page;
  CellSurvivors survivors;

  SimplifiedArc() {
    for (std::uint32_t x = 1; x + 1 < n; ++x) cell.positions[(n - 1) * n + x].y += arc(int(x));
    auto result = simplify_cell(cell, {.target_triangles = 60});
    page.vertex_count = std::uint32_t(cell.positions.size());
    page.triangles = cell.triangles;
    page.script = std::move(result.script);
    survivors = std::move(result.survivors);
  }
  void expect_rims_at_least(float error) const {
    std::size_t rims = 0;
    for (const Child& c : page.script.children) {
      if (cell.positions[c.vertex].y <= 50 * int(n - 1)) continue;
      EXPECT_GE(decode_error(c.error), error);
      ++rims;
    }
    EXPECT_GT(rims, 5u);
  }
  std::ptrdiff_t raised() const {
    return std::count_if(survivors.samples.points.begin(), survivors.samples.points.end(),
                         [](Vec3i p) { return p.z == 90; });
  }
};

/// What the rim leaves behind lies above and below no triangle that could be measured.
TEST(ExactErrors, postings_that_a_rim_uncovers_count_and_become_samples) {
  SimplifiedArc s;
  ASSERT_EQ(s.raised(), 0);
  ASSERT_TRUE(make_errors_exact(RaisedRim(s.n), s.cell, s.page, s.survivors));
  EXPECT_GT(s.raised(), 0);
  s.expect_rims_at_least(80);
  for (std::size_t i = 0; i < s.survivors.triangles.size(); ++i)
    for (std::uint32_t k = s.survivors.samples.begin[i]; k < s.survivors.samples.begin[i + 1]; ++k)
      if (s.survivors.samples.points[k].z == 90) {
        EXPECT_GE(s.survivors.births[i].error, 80) << "survivor " << i;
      }
}

TEST(ExactErrors, too_many_postings_beside_a_rim_are_as_far_as_can_be) {
  SimplifiedArc s;
  ASSERT_TRUE(make_errors_exact(RaisedRim(s.n, true), s.cell, s.page, s.survivors));
  s.expect_rims_at_least(50 * 23 * 1.4f);
  EXPECT_EQ(s.raised(), 0);
}

TEST(ExactErrors, an_error_of_reading_is_passed_on) {
  Simplified s;
  const auto done = s.judge(Judge(nullptr));
  ASSERT_FALSE(done);
  EXPECT_EQ(done.error().code, ErrorCode::io);
}

}  // namespace
}  // namespace cuesta
