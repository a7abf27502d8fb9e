/// The totally ordered mesh: what tom.h, build_tom.h and tom_codec.h say, on small surfaces and on scans.

#include <gtest/gtest.h>

#include <algorithm>
#include <functional>
#include <map>
#include <random>
#include <set>

#include "apps/measure/surface_distance.h"
#include "hierarchy/build_tom.h"
#include "hierarchy/tom_cursor.h"
#include "ooc/mesh_reader.h"
#include "tests/hierarchy/surfaces.h"
#include "tests/shared_data.h"

namespace cuesta::test {
namespace {

Tom tom_of(const SurfaceMesh& mesh, const TomOptions& options = {}, TomReport* report = nullptr) {
  auto tom = build_tom(mesh, options, report);
  EXPECT_TRUE(tom) << tom.error().text();
  return std::move(*tom);
}

/// The cut by brute force: all vertices from n on are replaced, one after the other, in all triangles.
std::vector<Triangle> substituted(const Tom& tom, Resolution n) {
  std::vector<Triangle> triangles = tom.triangles;
  for (std::uint32_t v = tom.full(); v-- > n;)
    for (Triangle& t : triangles) std::replace(t.begin(), t.end(), v, tom.substitute[v]);
  std::erase_if(triangles, [](const Triangle& t) { return is_degenerate(t); });
  return triangles;
}

std::vector<Triangle> extracted(const Tom& tom, Resolution n) {
  std::vector<Triangle> triangles(triangle_count(tom, n));
  EXPECT_EQ(extract_triangles(tom, n, triangles), triangles.size());
  return triangles;
}

/// Edges by position with how often they are run along one way less the other: none where the surface is
/// closed.
std::size_t open_edges(const Tom& tom, Resolution n) {
  std::map<std::pair<Vec3f, Vec3f>, int> balance;
  for (const Triangle& t : extracted(tom, n))
    for (std::size_t i = 0; i < 3; ++i) {
      const Vec3f a = tom.positions[t[i]], b = tom.positions[t[(i + 1) % 3]];
      if (a < b)
        ++balance[{a, b}];
      else
        --balance[{b, a}];
    }
  return static_cast<std::size_t>(
      std::count_if(balance.begin(), balance.end(), [](const auto& e) { return e.second != 0; }));
}

/// Each edge once each way, and V - E + F as given.
bool is_manifold_of_euler(const Tom& tom, Resolution n, long euler) {
  std::set<std::pair<Vec3f, Vec3f>> edges;
  std::set<Vec3f> points;
  const auto triangles = extracted(tom, n);
  for (const Triangle& t : triangles)
    for (std::size_t i = 0; i < 3; ++i) {
      points.insert(tom.positions[t[i]]);
      if (!edges.insert({tom.positions[t[i]], tom.positions[t[(i + 1) % 3]]}).second) return false;
    }
  return static_cast<long>(points.size()) - static_cast<long>(edges.size()) / 2 +
             static_cast<long>(triangles.size()) ==
         euler;
}

std::uint32_t components(const Tom& tom, Resolution n) {
  std::map<Vec3f, Vec3f> parent;
  const std::function<Vec3f(Vec3f)> root = [&](Vec3f p) {
    while (parent.try_emplace(p, p).first->second != p) p = parent[p];
    return p;
  };
  for (const Triangle& t : extracted(tom, n))
    for (std::size_t i = 0; i < 3; ++i)
      parent[root(tom.positions[t[i]])] = root(tom.positions[t[(i + 1) % 3]]);
  return static_cast<std::uint32_t>(
      std::count_if(parent.begin(), parent.end(), [](const auto& p) { return p.first == p.second; }));
}

std::vector<TomOptions> all_options() {
  std::vector<TomOptions> all;
  for (const TomOracle oracle : {TomOracle::manifold, TomOracle::any_edge, TomOracle::pairs})
    for (const TomFairness fairness :
         {TomFairness::quadric, TomFairness::attribute_quadric, TomFairness::memoryless})
      all.push_back({.oracle = oracle, .fairness = fairness, .pair_threshold = 0.2});
  return all;
}

TEST(Tom, total_order) {
  for (const NamedSurface& s : surfaces())
    for (const TomOptions& options : all_options()) {
      const Tom tom = tom_of(s.make(), options);
      SCOPED_TRACE(s.name);
      EXPECT_TRUE(is_consistent(tom));
      EXPECT_EQ(tom.triangles.size(), s.make().triangles.size());
      EXPECT_EQ(triangle_count(tom, tom.full()), tom.triangles.size());
      EXPECT_EQ(error_at(tom, tom.full()), 0.0f);
    }
}

TEST(Tom, extraction_is_brute_force_substitution) {
  const Tom toms[] = {tom_of(bumpy_sphere(5)), tom_of(faceted_cube(4)), tom_of(wavy_patch(9)),
                      tom_of(pebbles(), {.oracle = TomOracle::pairs, .pair_threshold = 0.5})};
  for (const Tom& tom : toms) {
    const Resolution step = tom.full() > 500 ? 37 : 1;
    for (Resolution n = tom.base_vertices; n <= tom.full(); n += step) {
      auto expected = substituted(tom, n), found = extracted(tom, n);
      EXPECT_EQ(found, expected) << n;
      EXPECT_EQ(triangle_count(tom, n), expected.size());
    }
  }
}

TEST(Tom, cursor_extracts_the_same_however_it_moves) {
  const Tom tom = tom_of(faceted_cube(12));
  TomCursor cursor(tom);
  std::mt19937 random(7);
  std::vector<Triangle> found(tom.triangles.size());
  Resolution n = tom.full();
  for (int i = 0; i < 600; ++i) {
    // Small steps, and now and then a jump.
    n = i % 50 == 0
            ? static_cast<Resolution>(tom.base_vertices + random() % (tom.full() - tom.base_vertices + 1))
            : std::clamp(static_cast<Resolution>(n + random() % 9 - 4), tom.base_vertices, tom.full());
    const auto expected = extracted(tom, n);
    ASSERT_EQ(cursor.extract(n, found), expected.size());
    ASSERT_TRUE(std::equal(expected.begin(), expected.end(), found.begin())) << n;
    std::vector<Triangle> visited;
    cursor.visit(n, [&](const Triangle& t) { visited.push_back(t); });
    ASSERT_EQ(visited, expected) << n;
    EXPECT_LE(cursor.followed(), n / 4 + 2);
  }
}

TEST(Tom, resolutions_are_found_by_triangles_and_by_error) {
  const Tom tom = tom_of(faceted_cube(12));
  for (std::uint32_t triangles = 0; triangles <= tom.triangles.size(); triangles += 7) {
    const Resolution n = resolution_of_triangles(tom, triangles);
    EXPECT_EQ(whole_resolution(tom, n), n);
    EXPECT_TRUE(triangle_count(tom, n) <= triangles || n == tom.base_vertices);
    Resolution next = n + 1;
    while (next < tom.full() && whole_resolution(tom, next) != next) ++next;
    if (n < tom.full()) {
      EXPECT_GT(triangle_count(tom, next), triangles);
    }
  }
  for (float error = 0; error < 1; error = error * 1.3f + 1e-4f) {
    const Resolution n = resolution_of_error(tom, error);
    EXPECT_EQ(whole_resolution(tom, n), n);
    EXPECT_LE(error_at(tom, n), error);
    if (n > tom.base_vertices) {
      EXPECT_GT(error_at(tom, whole_resolution(tom, n - 1)), error);
    }
  }
}

TEST(Tom, closed_manifold_stays_one_if_the_oracle_keeps_topology) {
  const std::pair<SurfaceMesh, long> closed[] = {
      {bumpy_sphere(9), 2}, {bumpy_torus(18, 12), 0}, {faceted_cube(6), 2}};
  for (const TomFairness fairness : {TomFairness::quadric, TomFairness::memoryless})
    for (const auto& [mesh, euler] : closed) {
      const Tom tom = tom_of(mesh, {.oracle = TomOracle::manifold, .fairness = fairness});
      EXPECT_LT(tom.base_vertices, 40u);
      for (Resolution n = tom.base_vertices; n <= tom.full(); ++n)
        EXPECT_TRUE(whole_resolution(tom, n) != n || is_manifold_of_euler(tom, n, euler)) << n;
    }
}

TEST(Tom, seams_stay_closed) {
  for (const TomOptions& options : all_options()) {
    const Tom tom = tom_of(faceted_cube(6), options);
    ASSERT_LT(tom.base_vertices, tom.full() / 4);
    std::uint32_t whole = 0;
    for (Resolution n = tom.base_vertices; n <= tom.full(); ++n) {
      if (whole_resolution(tom, n) != n) continue;
      ++whole;
      EXPECT_EQ(open_edges(tom, n), 0u) << n;
    }
    EXPECT_LT(whole, tom.full() - tom.base_vertices);  // some steps take several vertices
  }
}

TEST(Tom, same_input_same_order) {
  for (const TomOptions& options : all_options()) {
    const Tom a = tom_of(seamed_vase(24, 20), options), b = tom_of(seamed_vase(24, 20), options);
    EXPECT_EQ(a.substitute, b.substitute);
    EXPECT_EQ(a.triangles, b.triangles);
    EXPECT_EQ(a.positions, b.positions);
    EXPECT_EQ(a.errors, b.errors);
  }
}

TEST(Tom, pair_threshold_joins_components) {
  const SurfaceMesh two = joined(bumpy_sphere(6), bumpy_sphere(6, {2.05, 0, 0}));
  const auto fewest = [&](double threshold) {
    const Tom tom = tom_of(two, {.oracle = TomOracle::pairs, .pair_threshold = threshold});
    std::uint32_t least = 2;
    for (Resolution n = tom.full(); n > tom.full() / 20; --n)
      if (n >= tom.base_vertices) least = std::min(least, components(tom, n));
    return least;
  };
  EXPECT_EQ(fewest(0), 2u);
  EXPECT_EQ(fewest(0.3), 1u);
}

TEST(Tom, small_components_go) {
  const Tom tom = tom_of(pebbles());
  EXPECT_EQ(components(tom, tom.full()), 31u);
  EXPECT_EQ(components(tom, tom.base_vertices), 1u);
}

TEST(Tom, geomorph_ends_at_the_coarser_surface) {
  const Tom tom = tom_of(seamed_vase(16, 12));
  for (Resolution n = tom.full(); n > tom.base_vertices; n = whole_resolution(tom, n - 1)) {
    const auto fine = extracted(tom, n), coarse = extracted(tom, whole_resolution(tom, n - 1));
    Tom moved = tom;
    for (std::uint32_t v = whole_resolution(tom, n - 1); v < n; ++v) {
      const TomVertex none = geomorph(tom, v, 0), all = geomorph(tom, v, 1), half = geomorph(tom, v, 0.5f);
      EXPECT_EQ(none.position, tom.positions[v]);
      EXPECT_EQ(none.texcoord, tom.texcoords[v]);
      EXPECT_EQ(all.texcoord, tom.texcoords[tom.substitute[v]]);
      EXPECT_NEAR(length(half.position - (none.position + all.position) / 2.0f), 0, 1e-6);
      moved.positions[v] = all.position;
    }
    std::multiset<std::array<Vec3f, 3>> flat, expected;
    const auto add = [](auto& to, const Tom& from, const Triangle& t) {
      const Vec3f a = from.positions[t[0]], b = from.positions[t[1]], c = from.positions[t[2]];
      if (a != b && b != c && c != a)
        to.insert(std::min({std::array{a, b, c}, std::array{b, c, a}, std::array{c, a, b}}));
    };
    for (const Triangle& t : fine) add(flat, moved, t);
    for (const Triangle& t : coarse) add(expected, tom, t);
    EXPECT_EQ(flat, expected) << n;
  }
}

/// What is said of the error, against a measure that shares no geometry with the build.
void expect_honest_errors(const SurfaceMesh& mesh, const Tom& tom) {
  constexpr double rounding = 1e-12;  // of what measures
  float last = -1;
  for (Resolution n = tom.full(); n > tom.base_vertices + 2; n = n / 3) {
    n = std::max(n, tom.base_vertices);
    const auto measured = measure::vertex_distance(mesh, measure::make_tree(surface_at(tom, n)));
    EXPECT_LE(measured.percentiles.max, error_at(tom, n) + tom.snap_error + rounding) << n;
    EXPECT_GE(error_at(tom, n), last);
    last = error_at(tom, n);
  }
}

TEST(Tom, errors_bound_what_is_measured) {
  for (const NamedSurface& s : surfaces())
    for (const TomOptions& options : all_options()) {
      if (options.fairness == TomFairness::quadric && options.oracle != TomOracle::any_edge) continue;
      SCOPED_TRACE(s.name);
      const SurfaceMesh mesh = s.make();
      expect_honest_errors(mesh, tom_of(mesh, options));
    }
}

TEST(Tom, errors_of_a_scan_bound_what_is_measured) {
  CUESTA_NEED_SHARED(path, "mesh/fandisk.obj");
  auto mesh = load_mesh(path, std::uint64_t{1} << 30);
  ASSERT_TRUE(mesh);
  mesh->normals.clear();
  expect_honest_errors(*mesh, tom_of(*mesh));
}

TEST(Tom, flat_patches_stay_flat) {
  SurfaceMesh patch = wavy_patch(20);
  for (auto& p : patch.positions) p.z = 0;
  for (const TomFairness fairness : {TomFairness::quadric, TomFairness::memoryless}) {
    const Tom tom = tom_of(patch, {.fairness = fairness});
    const Resolution n = resolution_of_error(tom, 0);
    EXPECT_LT(n, 60u);
    for (const Triangle& t : extracted(tom, n))
      EXPECT_GT(cross(tom.positions[t[1]] - tom.positions[t[0]], tom.positions[t[2]] - tom.positions[t[0]]).z,
                0);
  }
}

TEST(Tom, bytes_per_vertex_and_triangle_are_as_the_header_says) {
  SurfaceMesh mesh = bumpy_sphere(40);
  for (const Vec3d& p : mesh.positions) mesh.normals.push_back(vec_cast<float>(normalized(p)));
  const Tom tom = tom_of(mesh);
  EXPECT_EQ(size_bytes(tom), 28ull * tom.full() + 12ull * tom.triangles.size() + 8ull * tom.errors.size());
  EXPECT_LE(tom.errors.size(), 200u);
  const std::uint64_t face_vertex = 24ull * tom.full() + 12ull * tom.triangles.size();
  EXPECT_LT(double(size_bytes(tom) - 8 * tom.errors.size()) / double(face_vertex), 1.085);
}

TEST(Tom, what_is_left_out_is_counted) {
  SurfaceMesh mesh = tetrahedron();
  const auto next = static_cast<std::uint32_t>(mesh.positions.size());
  mesh.positions.push_back({NAN, 0, 0});
  mesh.positions.push_back({5, 5, 5});
  mesh.positions.push_back(mesh.positions[0]);
  mesh.triangles.push_back({0, 1, next});
  mesh.triangles.push_back({0, next + 2, 1});
  TomReport report;
  const Tom tom = tom_of(mesh, {}, &report);
  EXPECT_EQ(tom.full(), 4u);
  EXPECT_EQ(tom.triangles.size(), 4u);
  EXPECT_EQ(report.bad_triangles, 1u);
  EXPECT_EQ(report.degenerate_triangles, 1u);
  EXPECT_EQ(report.unused_vertices, 2u);  // the lonely one, and that at no place
  EXPECT_EQ(report.welded_vertices, 1u);
}

TEST(Tom, nothing_makes_an_empty_one) {
  const Tom tom = tom_of({});
  EXPECT_TRUE(is_consistent(tom));
  EXPECT_EQ(tom.full(), 0u);
  EXPECT_FALSE(build_tom(tetrahedron(), {.step = 1e-12}));
  EXPECT_FALSE(build_tom(tetrahedron(), {.step = -1}));
}

}  // namespace
}  // namespace cuesta::test
