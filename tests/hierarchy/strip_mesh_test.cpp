/// Strips draw exactly the substituted mesh, at every resolution, however they got there.

#include <gtest/gtest.h>

#include <limits>

#include "hierarchy/build_strips.h"
#include "hierarchy/build_tom.h"
#include "hierarchy/strip_reduction.h"
#include "tests/hierarchy/surfaces.h"
#include "tests/hierarchy/totally_ordered.h"

namespace cuesta::test {
namespace {

constexpr double one_band = std::numeric_limits<double>::infinity();

std::vector<std::uint32_t> indices_of(const StripMesh& mesh) {
  std::vector<std::uint32_t> indices(mesh.index_bound());
  indices.resize(mesh.write_indices(indices));
  return indices;
}

std::vector<StripOptions> all_options() {
  return {{2, true}, {2, false}, {1.3, true}, {one_band, true}, {one_band, false}};
}

/// Down and up one by one, and by leaps.
void expect_brute_force(const TotallyOrdered& ordered, const StripOptions& options) {
  SCOPED_TRACE(testing::Message() << "band ratio " << options.band_ratio << ", dynamic "
                                  << options.dynamic_length);
  StripMesh mesh = build_strips(ordered.triangles, ordered.substitute, ordered.base, options);
  EXPECT_EQ(mesh.resolution(), ordered.full());
  EXPECT_EQ(mesh.base_resolution(), ordered.base);
  const auto expect_at = [&](std::uint32_t r) {
    mesh.set_resolution(r);
    ASSERT_EQ(drawn_by(indices_of(mesh)), brute_force(ordered, r)) << "resolution " << r;
  };
  for (std::uint32_t r = ordered.full(); r >= ordered.base; --r) expect_at(r);
  for (std::uint32_t r = ordered.base; r <= ordered.full(); ++r) expect_at(r);
  std::mt19937 random(7);
  for (int i = 0; i < 50; ++i)
    expect_at(ordered.base + static_cast<std::uint32_t>(random()) % (ordered.full() - ordered.base + 1));
}

std::vector<std::uint32_t> reduced(std::vector<std::uint32_t> strip) {
  std::vector<std::uint32_t> out(strip.size() + 1);
  out.resize(reduce_strip(strip, out.data()));
  return out;
}

TEST(StripReduction, repetitions_go_and_triangles_stay) {
  using Strip = std::vector<std::uint32_t>;
  EXPECT_EQ(reduced({1, 2, 3, 2, 3, 4}), (Strip{1, 2, 3, 4, strip_restart}));
  EXPECT_EQ(reduced({0, 1, 2, 2, 2, 2, 4, 5}), (Strip{0, 1, 2, 2, 4, 5, strip_restart}));
  EXPECT_EQ(reduced({1, 2, 2, 2, 2, 4, 5}), (Strip{2, 4, 5, strip_restart}));
  EXPECT_EQ(reduced({1, 1, 2, 3, 3}), (Strip{1, 1, 2, 3, strip_restart}))
      << "without the first, 1 2 3 is turned over";
  EXPECT_EQ(reduced({1, 2, 1, 2}), Strip{});
  EXPECT_EQ(reduced({}), Strip{});
}

TEST(StripMesh, triangles_are_those_of_the_substituted_mesh) {
  for (const SurfaceMesh& surface : {bumpy_sphere(6), bumpy_torus(14, 9)})
    for (const StripOptions& options : all_options()) expect_brute_force(collapse_order(surface, 3), options);
}

TEST(StripMesh, strips_of_a_tom_have_its_triangles) {
  for (const SurfaceMesh& surface : {bumpy_sphere(6), seamed_vase(10, 8), pebbles()}) {
    const auto tom = build_tom(surface);
    ASSERT_TRUE(tom) << tom.error().text();
    expect_brute_force({tom->triangles, tom->substitute, tom->base_vertices}, {});
  }
}

TEST(StripMesh, any_substitutes_will_do) {
  const SurfaceMesh surface = bumpy_sphere(5);
  const auto n = static_cast<std::uint32_t>(surface.positions.size());
  for (std::uint32_t seed = 1; seed <= 5; ++seed)
    for (const StripOptions& options : all_options()) {
      SCOPED_TRACE(seed);
      expect_brute_force(random_order(surface.triangles, n, 1, seed), options);
    }
}

TEST(StripMesh, up_again_is_the_same_stream) {
  const TotallyOrdered ordered = collapse_order(bumpy_sphere(8), 5);
  for (const StripOptions& options : all_options()) {
    StripMesh mesh = build_strips(ordered.triangles, ordered.substitute, ordered.base, options);
    const auto before = indices_of(mesh);
    for (std::uint32_t r = ordered.full(); r > ordered.base; --r) mesh.set_resolution(r);
    EXPECT_NE(indices_of(mesh), before);
    for (std::uint32_t r = ordered.base; r <= ordered.full(); ++r) mesh.set_resolution(r);
    EXPECT_EQ(indices_of(mesh), before);
  }
}

TEST(StripMesh, dynamic_length_draws_what_skipping_draws) {
  const TotallyOrdered ordered = collapse_order(bumpy_sphere(8), 5);
  StripMesh dynamic = build_strips(ordered.triangles, ordered.substitute, ordered.base, {one_band, true});
  std::uint64_t longest = indices_of(dynamic).size();
  for (std::uint32_t r = ordered.full(); r >= ordered.base; r -= std::min(r, 10u)) {
    dynamic.set_resolution(r);
    const auto indices = indices_of(dynamic);
    EXPECT_LE(indices.size(), longest) << "strips only get shorter";
    longest = indices.size();
    std::vector<std::uint32_t> strip;
    for (const std::uint32_t v : indices) {
      strip.push_back(v);
      if (v != strip_restart) continue;
      EXPECT_EQ(reduced({strip.begin(), strip.end() - 1}), strip) << "nothing is left to skip";
      strip.clear();
    }
  }
}

TEST(StripMesh, far_resolutions_cost_their_band_only) {
  const TotallyOrdered ordered = collapse_order(bumpy_sphere(20), 1);
  StripMesh bands = build_strips(ordered.triangles, ordered.substitute, ordered.base, {2, true});
  StripMesh one = build_strips(ordered.triangles, ordered.substitute, ordered.base, {one_band, true});
  const std::uint32_t far = ordered.full() / 5;
  EXPECT_EQ(one.set_resolution(far).steps, ordered.full() - far);
  EXPECT_LE(bands.set_resolution(far).steps, ordered.full() / 4);
  EXPECT_LT(indices_of(bands).size(), indices_of(one).size());
}

TEST(StripMesh, surfaces_may_vanish_or_be_none) {
  const std::vector<Triangle> one{{0, 1, 2}}, degenerate{{0, 1, 1}}, nothing;
  const std::vector<std::uint32_t> substitute{0, 0, 0};
  for (const StripOptions& options : all_options()) {
    StripMesh mesh = build_strips(one, substitute, 1, options);
    EXPECT_EQ(indices_of(mesh).size(), 4u);
    mesh.set_resolution(1);
    EXPECT_TRUE(indices_of(mesh).empty());
    mesh.set_resolution(3);
    EXPECT_EQ(drawn_by(indices_of(mesh)), one);
    for (const auto& triangles : {degenerate, nothing})
      EXPECT_TRUE(indices_of(build_strips(triangles, substitute, 1, options)).empty());
    EXPECT_TRUE(indices_of(build_strips({}, std::vector<std::uint32_t>{0}, 1, options)).empty());
  }
}

TEST(StripMesh, sheets_that_share_edges_are_drawn_as_often_as_they_come) {
  const std::vector<Triangle> triangles{{0, 1, 2}, {0, 2, 1}, {0, 1, 3}, {1, 0, 4}, {0, 1, 2}, {2, 1, 4}};
  for (const StripOptions& options : all_options())
    expect_brute_force({triangles, {0, 0, 0, 1, 3}, 2}, options);
}

/// How many windows between two triangles of a strip are degenerate, at most, at resolution r after
/// reduction.
std::size_t widest_gap(const StripSet& strips, const TotallyOrdered& ordered, std::uint32_t r) {
  std::size_t widest = 0;
  for (std::uint32_t s = 0; s < strips.strip_count(); ++s) {
    std::vector<std::uint32_t> strip;
    for (std::uint32_t v : strips.strip(s)) {
      v = ordered.number[v];
      while (v >= r) v = ordered.substitute[v];
      strip.push_back(v);
    }
    strip = reduced(strip);
    std::size_t gap = 0;
    for (std::size_t i = 0; i + 3 < strip.size(); ++i) {
      gap = is_degenerate(&strip[i]) ? gap + 1 : 0;
      widest = std::max(widest, gap);
    }
  }
  return widest;
}

TEST(StripSides, strips_stay_strips) {
  const SurfaceMesh surface = bumpy_torus(24, 16);
  const StripSet strips = stripify(surface.triangles, static_cast<std::uint32_t>(surface.positions.size()));
  StripSides sides(strips);
  const TotallyOrdered free = collapse_order(surface, 1), along = collapse_order(surface, 1, &sides);
  EXPECT_LT(along.base, along.full() / 2) << "there is something to restrict";
  std::size_t widest_free = 0;
  for (std::uint32_t r = free.full(); r > free.full() / 2; --r) {
    widest_free = std::max(widest_free, widest_gap(strips, free, r));
    EXPECT_LE(widest_gap(strips, along, r), 1u) << "resolution " << r;
  }
  EXPECT_GT(widest_free, 1u);
  for (const StripOptions& options : all_options()) expect_brute_force(along, options);
}

TEST(Stripify, strips_have_the_triangles_and_do_not_cross_what_they_may_not) {
  const SurfaceMesh surface = bumpy_torus(30, 20);
  const auto n = static_cast<std::uint32_t>(surface.positions.size());
  const auto list = [](const StripSet& set) {
    std::vector<std::uint32_t> out;
    for (std::uint32_t s = 0; s < set.strip_count(); ++s) {
      const auto strip = set.strip(s);
      out.insert(out.end(), strip.begin(), strip.end());
      out.push_back(strip_restart);
    }
    return out;
  };
  const StripSet free = stripify(surface.triangles, n),
                 single = stripify(surface.triangles, n, [](auto, auto) { return false; });
  EXPECT_EQ(drawn_by(list(free)), sorted(surface.triangles));
  EXPECT_EQ(drawn_by(list(single)), sorted(surface.triangles));
  EXPECT_EQ(single.strip_count(), surface.triangles.size());
  EXPECT_LT(list(free).size(), surface.triangles.size() * 13 / 10);
}

}  // namespace
}  // namespace cuesta::test
