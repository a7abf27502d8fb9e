/// Distances of triangles from postings, against looking at every posting.

#include "terrain/posting_measure.h"

#include <tbb/global_control.h>
#include <tbb/task_arena.h>

#include "tests/terrain/small_terrains.h"

namespace cuesta {
namespace {

using test::SmallTerrain;
using test::Surveyed;
using Corners = std::array<Vec3i, 3>;

/// Snapped postings of all layers, in grid units.
std::vector<Vec3d> postings_of(const Surveyed& terrain, const Grid& grid) {
  std::vector<Vec3d> out;
  for (std::uint32_t l = 0; l < terrain.mosaic().layers().size(); ++l)
    for (const Vec3d& p : terrain.positions_m(l))
      if (test::is_place(p)) out.push_back(vec_cast<double>(grid.snap(p)));
  return out;
}

/// Solves p + h · up = a + b · ab + c · ac by Cramer's rule.
/// @return |h|, or -1 outside of a triangle that is larger by a share of its sides
double distance_along(Vec3d up, Vec3d p, const std::array<Vec3d, 3>& t, double larger) {
  const Vec3d ab = t[1] - t[0], ac = t[2] - t[0], n = cross(ab, ac), q = p - t[0];
  const double det = dot(up, n);
  if (!(det > 0)) return -1;
  const double b = dot(up, cross(q, ac)) / det, c = dot(up, cross(ab, q)) / det;
  if (b < -larger || c < -larger || b + c > 1 + larger) return -1;
  return std::abs(dot(q, n) / det) * length(up);
}

/// The distance of a triangle without its rim, and with what rounding may count to it.
struct Distances {
  double least = 0, most = 0;
};
Distances brute_force(const std::vector<Vec3d>& postings, const Vertical& vertical, const Corners& corners) {
  const std::array<Vec3d, 3> t{vec_cast<double>(corners[0]), vec_cast<double>(corners[1]),
                               vec_cast<double>(corners[2])};
  Distances d;
  for (const Vec3d& p : postings) {
    d.least = std::max(d.least, distance_along(vertical.direction(p), p, t, -1e-8));
    d.most = std::max(d.most, distance_along(vertical.direction(p), p, t, 1e-8));
  }
  return d;
}

/// Half of them of postings anywhere, the others of postings that are near each other; facing up.
std::vector<Corners> random_triangles(std::mt19937& random, const std::vector<Vec3d>& postings,
                                      const Vertical& vertical, std::size_t count) {
  std::vector<Corners> out;
  const auto any = [&](std::size_t n) {
    return std::uniform_int_distribution<std::size_t>(0, n - 1)(random);
  };
  while (out.size() < count) {
    std::size_t i[3] = {any(postings.size()), any(postings.size()), any(postings.size())};
    if (out.size() % 2 != 0) {
      i[1] = (i[0] + any(60)) % postings.size();
      i[2] = (i[0] + any(60)) % postings.size();
    }
    Vec3d a = postings[i[0]], b = postings[i[1]], c = postings[i[2]];
    const Vec3d n = cross(b - a, c - a), up = vertical.direction((a + b + c) / 3);
    if (!(std::abs(dot(n, up)) > 1e-3 * length(n) * length(up))) continue;
    if (dot(n, up) < 0) std::swap(b, c);
    out.push_back({vec_cast<std::int32_t>(a), vec_cast<std::int32_t>(b), vec_cast<std::int32_t>(c)});
  }
  return out;
}

TEST(PostingMeasure, agrees_with_looking_at_every_posting) {
  for (const double voids : {0.0, 0.2})
    for (unsigned seed = 1; seed <= 3; ++seed)
      for (const SmallTerrain& terrain : test::small_terrains(seed, voids)) {
        SCOPED_TRACE(fmt::format("{}, seed {}, voids {}", terrain.name, seed, voids));
        Surveyed surveyed(terrain);
        const auto surface = surveyed.survey({.square_side = 8});
        ASSERT_TRUE(surface);
        const auto postings = postings_of(surveyed, surface->grid);
        std::mt19937 random(seed);
        const auto triangles = random_triangles(random, postings, *surface->vertical, 400);
        std::vector<float> distances(triangles.size(), -1);
        ASSERT_TRUE(surface->measure(triangles, distances));
        for (std::size_t i = 0; i < triangles.size(); ++i) {
          const auto [least, most] = brute_force(postings, *surface->vertical, triangles[i]);
          const double rounding = 1e-3 + 1e-6 * most;
          ASSERT_GE(double(distances[i]), least - rounding) << "triangle " << i;
          ASSERT_LE(double(distances[i]), most + rounding) << "triangle " << i;
        }
      }
}

/// Of triangles with their corners on postings no posting between two others may be left out: whole rows and
/// columns lie on their edges.
TEST(PostingMeasure, postings_on_edges_count) {
  std::vector<double> heights(30 * 30, 0);
  heights[10 * 30 + 15] = 77;  // on the upper edge of the triangle below
  const SmallTerrain terrain{
      "edge", {{"a.asc", test::grid(0, 290, 10, 30, heights)}}, Frame::projected(Crs::plane()).value(), {}};
  Surveyed surveyed(terrain);
  const auto surface = surveyed.survey({.square_side = 8});
  ASSERT_TRUE(surface);
  const auto at = [&](int column, int row) {
    return surface->grid.snap({10.0 * column, 290 - 10.0 * row, 0});
  };
  const std::vector<Corners> triangles{{at(5, 10), at(15, 20), at(25, 10)},   // on its edge
                                       {at(15, 10), at(5, 20), at(25, 20)},   // at its corner
                                       {at(5, 11), at(15, 20), at(25, 11)}};  // just outside
  std::vector<float> distances(3);
  ASSERT_TRUE(surface->measure(triangles, distances));
  const auto expected = float(77 / surface->grid.step);
  EXPECT_EQ(distances[0], expected);
  EXPECT_EQ(distances[1], expected);
  EXPECT_EQ(distances[2], 0);
}

TEST(PostingMeasure, the_surface_itself_is_at_its_postings) {
  for (const SmallTerrain& terrain : test::small_terrains(4, 0.1)) {
    SCOPED_TRACE(terrain.name);
    Surveyed surveyed(terrain);
    const auto surface = surveyed.survey({.square_side = 9});
    ASSERT_TRUE(surface);
    std::vector<Corners> triangles;
    for (std::uint32_t c = 0; c < surface->chunk_count(); ++c) {
      const auto chunk = surface->chunk(c).value();
      const auto& at = chunk.vertices.positions;
      for (const Triangle& t : chunk.triangles) triangles.push_back({at[t[0]], at[t[1]], at[t[2]]});
    }
    std::vector<float> distances(triangles.size());
    ASSERT_TRUE(surface->measure(triangles, distances));
    // Snapping moves postings under neighbouring triangles by half a step, which slopes make more of.
    const auto far = std::count_if(distances.begin(), distances.end(), [](float d) { return d > 64; });
    EXPECT_LE(far, std::ptrdiff_t(triangles.size() / 50));
  }
}

TEST(PostingMeasure, same_bits_for_any_number_of_threads_and_squares) {
  const tbb::global_control threads(tbb::global_control::max_allowed_parallelism, 4);
  for (const SmallTerrain& terrain : test::small_terrains(9, 0.1)) {
    SCOPED_TRACE(terrain.name);
    Surveyed surveyed(terrain);
    const auto small = surveyed.survey({.square_side = 5}), large = surveyed.survey();
    ASSERT_TRUE(small && large);
    std::mt19937 random(9);
    const auto triangles =
        random_triangles(random, postings_of(surveyed, small->grid), *small->vertical, 700);
    std::vector<float> one(triangles.size()), four(triangles.size()), whole(triangles.size());
    tbb::task_arena(1).execute([&] { ASSERT_TRUE(small->measure(triangles, one)); });
    tbb::task_arena(4).execute([&] { ASSERT_TRUE(small->measure(triangles, four)); });
    ASSERT_TRUE(large->measure(triangles, whole));
    EXPECT_EQ(one, four);
    EXPECT_EQ(one, whole);
  }
}

}  // namespace
}  // namespace cuesta
