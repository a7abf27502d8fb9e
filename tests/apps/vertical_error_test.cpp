#include "apps/measure/vertical_error.h"

#include <gtest/gtest.h>
#include <tbb/task_arena.h>

#include <limits>

#include "measure_shapes.h"
#include "terrain/frame.h"

namespace cuesta::measure {
namespace {

using test::square;

/// square(n) stretched to `side_m` metres about a place far from the origin, with random inner vertices and
/// heights.
SurfaceMesh rough_square(std::uint32_t n, double side_m, unsigned seed) {
  SurfaceMesh mesh = square(n, 0);
  std::mt19937 bits(seed);
  std::uniform_real_distribution<double> unit(-1, 1);
  for (Vec3d& p : mesh.positions) {
    const bool inner = p.x > 0 && p.x < 1 && p.y > 0 && p.y < 1;
    const double shift = inner ? 0.2 / n : 0;
    p = {500'000 + side_m * (p.x + shift * unit(bits)), 4'000'000 + side_m * (p.y + shift * unit(bits)),
         1000 + 100 * unit(bits)};
  }
  return mesh;
}

std::vector<Vec3d> postings_of(std::uint32_t n, double side_m, double height_m) {
  std::vector<Vec3d> postings;
  for (std::uint32_t r = 0; r <= n; ++r)
    for (std::uint32_t c = 0; c <= n; ++c)
      postings.push_back({500'000 + side_m * c / n, 4'000'000 + side_m * r / n, height_m});
  return postings;
}

/// All triangles for every posting, in barycentric coordinates; negative: uncovered.
double brute_force(const SurfaceMesh& mesh, Vec3d p) {
  double found = -1;
  for (const auto& t : mesh.triangles) {
    const Vec3d a = mesh.positions[t[0]], u = mesh.positions[t[1]] - a, v = mesh.positions[t[2]] - a,
                w = p - a;
    const double area = u.x * v.y - u.y * v.x;
    const double s = (w.x * v.y - w.y * v.x) / area, q = (u.x * w.y - u.y * w.x) / area;
    if (s < -1e-12 || q < -1e-12 || s + q > 1 + 1e-12) continue;
    found = std::max(found, std::abs(w.z - s * u.z - q * v.z));
  }
  return found;
}

TEST(VerticalError, is_measured_upwards_not_across) {
  // A slope of 3 in 4 with postings 5 above it: their distance from the plane is 4.
  SurfaceMesh mesh = square(2, 0);
  for (Vec3d& p : mesh.positions) p = {8 * p.x, 8 * p.y, 6 * p.x};
  const std::vector<Vec3d> postings{{1, 1, 5.75}, {4, 4, 8}, {7.5, 2, 5.625 - 1}};
  const VerticalError error = vertical_error(mesh, postings, {.bound_m = 4.999});
  EXPECT_EQ(error.postings, 3u);
  EXPECT_EQ(error.exact.uncovered, 0u);
  EXPECT_NEAR(error.exact.max_m, 5, 1e-12);
  EXPECT_NEAR(error.exact.p999_m, 5, 1e-12);
  EXPECT_EQ(error.exact.beyond, 2u);
}

TEST(VerticalError, a_displaced_vertex_is_found) {
  SurfaceMesh mesh = square(10, 20);
  const std::vector<Vec3d> postings = mesh.positions;
  EXPECT_EQ(vertical_error(mesh, postings).exact.max_m, 0);
  mesh.positions[37].z += 7;
  const VerticalError error = vertical_error(mesh, postings, {.bound_m = 6.5});
  EXPECT_EQ(error.exact.max_m, 7);
  EXPECT_EQ(error.exact.worst, 37u);
  EXPECT_EQ(error.exact.beyond, 1u);
  EXPECT_EQ(error.exact.p999_m, 7);  // the nearest rank of 121
}

TEST(VerticalError, a_removed_triangle_is_found) {
  SurfaceMesh mesh = square(4, 0);
  for (Vec3d& p : mesh.positions) p = p * 40.0;
  std::vector<Vec3d> postings;
  for (int r = 0; r <= 40; ++r)
    for (int c = 0; c <= 40; ++c) postings.push_back({double(c), double(r), 1});
  mesh.triangles.erase(mesh.triangles.begin() + 10);
  // Of its 66 postings 30 are on its edges, which its neighbours have too.
  const VerticalError error = vertical_error(mesh, postings);
  EXPECT_EQ(error.exact.uncovered, 36u);
  EXPECT_EQ(error.exact.max_m, 1);
}

TEST(VerticalError, a_narrow_crack_is_found) {
  SurfaceMesh mesh =
      square(2, 0);  // vertex 4 is the middle: the triangles left of x = 0.5 get one of their own
  mesh.positions.push_back({0.499, 0.5, 0});
  for (auto& t : mesh.triangles)
    if (mesh.positions[t[0]].x + mesh.positions[t[1]].x + mesh.positions[t[2]].x < 1.4)
      for (std::uint32_t& v : t)
        if (v == 4) v = 9;
  std::vector<Vec3d> postings;
  for (int i = 0; i <= 1000; ++i)
    postings.push_back({i / 1000.0, 0.5, 0}), postings.push_back({0.4999, i / 1000.0, 0});
  EXPECT_GT(vertical_error(mesh, postings).exact.uncovered, 500u);
}

TEST(VerticalError, postings_on_edges_and_vertices_are_covered) {
  for (unsigned seed = 1; seed <= 4; ++seed) {
    const SurfaceMesh mesh = rough_square(20, 777, seed);
    std::vector<Vec3d> postings = mesh.positions;
    for (const auto& t : mesh.triangles)
      for (const double share : {0.5, 1 / 3.0, 0.1, 1e-9})
        postings.push_back(mesh.positions[t[0]] * share + mesh.positions[t[1]] * (1 - share));
    // A point of the outer border, rounded, may lie outside of it.
    const VerticalError error = vertical_error(mesh, postings, {.slack_m = 1e-9});
    EXPECT_EQ(error.with_slack.uncovered, 0u) << seed;
    EXPECT_LE(error.exact.uncovered, 4 * 80u);
    EXPECT_LT(error.with_slack.max_m, 1e-6);
  }
}

TEST(VerticalError, agrees_with_looking_at_all_triangles) {
  for (unsigned seed = 1; seed <= 3; ++seed) {
    SurfaceMesh mesh = rough_square(9, 900, seed);
    mesh.triangles.erase(mesh.triangles.begin() + 20 * seed);
    // Slivers and large triangles beside small ones.
    mesh.positions.push_back({500'000, 3'999'000, 0});
    mesh.positions.push_back({500'900, 3'999'999, 500});
    mesh.triangles.push_back({0, 100, 9});
    mesh.triangles.push_back({100, 101, 9});
    std::vector<Vec3d> postings = postings_of(61, 950, 1000);
    for (const Vec3d& p : postings_of(40, 1000, 10)) postings.push_back(p - Vec3d{50, 1000, 0});
    std::uint64_t uncovered = 0;
    double most = 0;
    for (const Vec3d& p : postings) {
      const double d = brute_force(mesh, p);
      uncovered += d < 0;
      most = std::max(most, d);
    }
    ASSERT_GT(uncovered, 50u);
    const VerticalError error = vertical_error(mesh, postings);
    EXPECT_EQ(error.exact.uncovered, uncovered) << seed;
    EXPECT_NEAR(error.exact.max_m, most, 1e-6) << seed;
  }
}

TEST(VerticalError, folds_do_not_hide_errors) {
  SurfaceMesh mesh = square(1, 3);
  mesh.positions.insert(mesh.positions.end(), {{0, 0, -9}, {1, 0, -9}, {0, 1, -9}});
  mesh.triangles.push_back({6, 5, 4});
  const std::vector<Vec3d> postings{{0.2, 0.2, 3}, {0.9, 0.9, 3}};
  const VerticalError error = vertical_error(mesh, postings);
  EXPECT_EQ(error.exact.max_m, 12);
  EXPECT_EQ(error.exact.worst, 0u);
}

TEST(VerticalError, slack_covers_what_snapping_uncovers_and_no_more) {
  SurfaceMesh mesh = square(10, 0);
  const std::vector<Vec3d> postings = mesh.positions;
  for (Vec3d& p : mesh.positions) p = {0.001 + 0.998 * p.x, p.y, 2 * p.x};
  EXPECT_EQ(vertical_error(mesh, postings).exact.uncovered, 22u);
  EXPECT_EQ(vertical_error(mesh, postings, {.slack_m = 0.0009}).with_slack.uncovered, 22u);
  const VerticalError error = vertical_error(mesh, postings, {.slack_m = 0.0011});
  EXPECT_EQ(error.exact.uncovered, 22u);
  EXPECT_EQ(error.with_slack.uncovered, 0u);
  EXPECT_NEAR(error.with_slack.max_m, 2, 1e-9);
}

/// Three postings in a row, of which snapping has moved the middle one aside: a steep sliver lies over where
/// it was.
TEST(VerticalError, slack_excuses_steep_slivers_and_nothing_beyond_them) {
  SurfaceMesh mesh;
  mesh.positions = {{0, 0, 0}, {1, 0.004, 0}, {2, 0, 100}, {1, 1, 0}, {1, -1, 50}};
  mesh.triangles = {{0, 1, 3}, {1, 2, 3}, {0, 2, 1}, {0, 4, 2}};
  const std::vector<Vec3d> postings{{1, 0, 0}, {1, 0.5, 0}, {1, -0.5, 50}};
  const VerticalError error = vertical_error(mesh, postings, {.bound_m = 2, .slack_m = 0.005});
  EXPECT_EQ(error.exact.beyond, 1u);
  EXPECT_NEAR(error.exact.max_m, 50, 1e-9);
  EXPECT_EQ(error.with_slack.beyond, 0u);
  EXPECT_LT(error.with_slack.max_m, 1e-9);
  mesh.positions[1].z = 3;
  EXPECT_EQ(vertical_error(mesh, postings, {.bound_m = 2, .slack_m = 0.005}).with_slack.beyond, 1u);
  EXPECT_EQ(vertical_error(mesh, postings, {.bound_m = 2, .slack_m = 0.003}).with_slack.beyond, 1u);
}

/// A slope of 10 in 1 that ends at x = 4, where it is 40 high; postings have been left beside it.
TEST(VerticalError, beside_a_rim_that_has_moved) {
  SurfaceMesh mesh = square(4, 0);
  for (Vec3d& p : mesh.positions) p = {4 * p.x, 4 * p.y, 40 * p.x};
  const std::vector<Vec3d> postings{{7, 2, 44}, {4.5, 1, 40}, {4.25, 3, 70}, {30, 2, 40}, {1, 1, 90}};
  const VerticalError error = vertical_error(mesh, postings, {.bound_m = 5, .rim_m = 20});
  EXPECT_EQ(error.exact.uncovered, 4u);
  EXPECT_EQ(error.exact.beyond, 1u);
  EXPECT_EQ(error.beside.uncovered, 1u);
  EXPECT_EQ(error.beside.beyond, 1u);
  EXPECT_EQ(error.beside.worst, 2u);
  EXPECT_NEAR(error.beside.max_m, std::hypot(0.25, 30), 1e-12);
  const VerticalError first = vertical_error(mesh, std::span(postings).first(1), {.bound_m = 5, .rim_m = 3});
  EXPECT_NEAR(first.beside.max_m, 5, 1e-12);
  EXPECT_EQ(first.beside.beyond, 0u);
}

TEST(VerticalError, no_data_does_not_count) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const std::vector<Vec3d> postings{{0.5, 0.5, nan}, {0.5, 0.25, 1}, {nan, nan, nan}};
  const VerticalError error = vertical_error(square(1, 0), postings);
  EXPECT_EQ(error.postings, 1u);
  EXPECT_EQ(error.exact.worst, 1u);
  EXPECT_EQ(vertical_error({}, postings).exact.uncovered, 1u);
  EXPECT_EQ(vertical_error(square(1, 0), {}).postings, 0u);
}

TEST(VerticalError, same_bits_for_any_number_of_threads) {
  const SurfaceMesh mesh = rough_square(60, 3000, 9);
  const std::vector<Vec3d> postings = postings_of(300, 3000, 1020);
  const auto measured = [&](int threads) {
    tbb::task_arena arena(threads);
    return arena.execute([&] { return vertical_error(mesh, postings, {.bound_m = 60}); });
  };
  const VerticalError one = measured(1), four = measured(4);
  EXPECT_GT(one.exact.beyond, 0u);
  EXPECT_EQ(one.exact.max_m, four.exact.max_m);
  EXPECT_EQ(one.exact.p999_m, four.exact.p999_m);
  EXPECT_EQ(one.exact.worst, four.exact.worst);
  EXPECT_EQ(one.exact.beyond, four.exact.beyond);
}

UpAt up_of(const Frame& frame) {
  return [&frame](Vec3d p) { return frame.up(p); };
}

/// square(n) from a corner in degrees, at a height that alternates.
SurfaceMesh tile(const Frame& frame, std::uint32_t n, Geodetic corner, double side_deg) {
  SurfaceMesh mesh = square(n, 0);
  for (std::size_t v = 0; v < mesh.positions.size(); ++v) {
    const Vec3d p = mesh.positions[v];
    mesh.positions[v] = frame.position_m(Geodetic{
        corner.lat_deg + side_deg * p.y, corner.lon_deg + side_deg * p.x, corner.h_m + (v % 2 ? 40.0 : 0.0)});
  }
  return mesh;
}

TEST(VerticalError, up_is_that_of_the_frame) {
  const Frame frames[] = {Frame::ecef(), Frame::enu({47.3, 11.2, 600}).value()};
  for (const Frame& frame : frames) {
    SurfaceMesh mesh = tile(frame, 50, {46.9, 10.8, 2500}, 1);
    const std::vector<Vec3d> postings = mesh.positions;
    VerticalError error = vertical_error(mesh, postings, {.up = up_of(frame), .slack_m = 1e-6});
    EXPECT_EQ(error.with_slack.uncovered, 0u);
    EXPECT_LT(error.exact.max_m, 1e-6);
    const Geodetic place = frame.geodetic(mesh.positions[1300]);
    mesh.positions[1300] = frame.position_m(Geodetic{place.lat_deg, place.lon_deg, place.h_m - 12.5});
    mesh.triangles.erase(mesh.triangles.begin(), mesh.triangles.begin() + 2);
    error = vertical_error(mesh, postings, {.up = up_of(frame), .bound_m = 12, .slack_m = 1e-6});
    EXPECT_NEAR(error.exact.max_m, 12.5, 1e-5);
    EXPECT_EQ(error.exact.worst, 1300u);
    EXPECT_EQ(error.exact.beyond, 1u);
    EXPECT_EQ(error.with_slack.uncovered, 1u);  // the corner
  }
}

/// Around the poles and over the antimeridian too. Chords of 10 degrees lie up to 48 km below the ellipsoid.
TEST(VerticalError, the_whole_globe_is_watertight) {
  const Frame globe = Frame::ecef();
  SurfaceMesh mesh = test::sphere(36, 1);
  for (Vec3d& p : mesh.positions) {
    const double lat = std::asin(std::clamp(p.z, -1.0, 1.0)) * 180 / std::numbers::pi;
    p = globe.position_m(Geodetic{lat, std::atan2(p.y, p.x) * 180 / std::numbers::pi, 0});
  }
  std::vector<Vec3d> postings;
  for (double lat = -90; lat <= 90; lat += 0.73)
    for (double lon = -180; lon < 180; lon += 0.61)
      postings.push_back(globe.position_m(Geodetic{lat, lon, 10}));
  VerticalError error = vertical_error(mesh, postings, {.up = up_of(globe), .slack_m = 1e-6});
  EXPECT_EQ(error.with_slack.uncovered, 0u);
  EXPECT_LT(error.exact.uncovered, 10u);
  EXPECT_GT(error.exact.max_m, 15'000);
  EXPECT_LT(error.exact.max_m, 49'000);
  mesh.triangles.erase(mesh.triangles.begin() + 36 * 36);
  error = vertical_error(mesh, postings, {.up = up_of(globe), .slack_m = 1e-6});
  EXPECT_GT(error.with_slack.uncovered, 50u);
  EXPECT_LT(error.with_slack.uncovered, 200u);
}

/// A chord's shadow is not straight on the cube's face: postings on both sides of the middle of a long edge,
/// so close that their bins are narrower than that.
TEST(VerticalError, long_edges_bend_on_the_ellipsoid) {
  const Frame globe = Frame::ecef();
  SurfaceMesh mesh;
  for (const LatLon at : {LatLon{38, 1}, {44, 14}, {47, 3}, {36, 12}})
    mesh.positions.push_back(globe.position_m(Geodetic{at.lat_deg, at.lon_deg, 0}));
  mesh.triangles = {{0, 1, 2}, {1, 0, 3}};
  const Geodetic middle = globe.geodetic((mesh.positions[0] + mesh.positions[1]) / 2);
  std::vector<Vec3d> postings;
  for (int r = -50; r <= 50; ++r)
    for (int c = -50; c <= 50; ++c)
      postings.push_back(
          globe.position_m(Geodetic{middle.lat_deg + r * 1e-5, middle.lon_deg + c * 1e-5, 100}));
  EXPECT_EQ(vertical_error(mesh, postings, {.up = up_of(globe)}).exact.uncovered, 0u);
}

}  // namespace
}  // namespace cuesta::measure
