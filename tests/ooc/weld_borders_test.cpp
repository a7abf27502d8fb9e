/// Borders within a tolerance of each other are joined: against brute force, and the same however it is done.

#include <gtest/gtest.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <numeric>
#include <random>
#include <set>

#include "ooc/border_sweep.h"
#include "tests/ooc/check_grid_mesh.h"
#include "tests/ooc/grid_mesh.h"
#include "tests/ooc/mesh_files.h"
#include "tests/ooc/small_meshes.h"

namespace cuesta {
namespace {

using namespace test;
using Moves = std::map<Vec3i, Vec3i>;

std::vector<Vec3i> in_order(std::vector<Vec3i> points) {
  std::sort(points.begin(), points.end());
  points.erase(std::unique(points.begin(), points.end()), points.end());
  std::stable_sort(points.begin(), points.end(),
                   [](Vec3i a, Vec3i b) { return BorderSweep::order(a) < BorderSweep::order(b); });
  return points;
}

double distance(Vec3i a, Vec3i b) {
  return length(vec_cast<double>(a) - vec_cast<double>(b));
}

/// What border_sweep.h says, word by word.
Moves moves_by_definition(const std::vector<Vec3i>& points, double tolerance) {
  std::vector<Vec3i> centres;
  for (const Vec3i& p : points)
    if (std::none_of(centres.begin(), centres.end(), [&](Vec3i c) { return distance(p, c) <= tolerance; }))
      centres.push_back(p);
  Moves moves;
  for (const Vec3i& p : points)
    moves[p] = *std::min_element(centres.begin(), centres.end(),
                                 [&](Vec3i a, Vec3i b) { return distance(p, a) < distance(p, b); });
  return moves;
}

Moves swept(const std::vector<Vec3i>& points, double tolerance) {
  BorderSweep sweep(tolerance);
  Moves moves;
  std::size_t next = 0;
  const auto take = [&] {
    for (std::pair<Vec3i, Vec3i> one; sweep.take(one); ++next) {
      EXPECT_EQ(one.first, points.at(next));
      moves[one.first] = one.second;
    }
  };
  for (const Vec3i& p : points) {
    sweep.add(p);
    take();
  }
  sweep.finish();
  take();
  EXPECT_EQ(next, points.size());
  return moves;
}

TEST(BorderSweep, IsItsDefinition) {
  for (std::uint32_t seed = 0; seed < 60; ++seed) {
    SCOPED_TRACE(seed);
    std::mt19937 random(seed);
    const std::int32_t size = std::int32_t{1} << (3 + seed % 8);
    std::uniform_int_distribution<std::int32_t> coordinate(0, size - 1);
    const double tolerance = 1 + size * 0.25 * static_cast<double>(random() % 100) / 100.0;
    std::vector<Vec3i> points(300);
    for (Vec3i& p : points) p = {coordinate(random), coordinate(random), seed % 3 ? coordinate(random) : 0};
    points = in_order(points);
    EXPECT_TRUE(swept(points, tolerance) == moves_by_definition(points, tolerance));
  }
}

TEST(BorderSweep, NothingMovesFartherThanTheToleranceAndCentresAreFarther) {
  std::mt19937 random(7);
  std::uniform_int_distribution<std::int32_t> coordinate((1 << 30) - 3000, (1 << 30) - 1);
  std::vector<Vec3i> points(20'000);
  for (Vec3i& p : points) p = {coordinate(random), coordinate(random), coordinate(random) / 100};
  const double tolerance = 57.5;
  const Moves moves = swept(in_order(points), tolerance);
  std::set<Vec3i> centres;
  for (const auto& [from, to] : moves) {
    EXPECT_LE(distance(from, to), tolerance);
    EXPECT_EQ(moves.at(to), to);
    centres.insert(to);
  }
  for (auto a = centres.begin(); a != centres.end(); ++a)
    for (auto b = std::next(a); b != centres.end() && b->x - a->x <= tolerance; ++b)
      ASSERT_GT(distance(*a, *b), tolerance);
}

/// Tiles of a patch, each with vertices of its own; inner borders are off by at most `crack` in each axis.
SurfaceMesh cracked_tiles(int n, int tiles, double crack) {
  const SurfaceMesh whole = wavy_patch(n);
  std::mt19937 random(3);
  std::uniform_real_distribution<double> off(-crack, crack);
  SurfaceMesh out;
  std::map<std::pair<int, std::uint32_t>, std::uint32_t> number;
  for (std::size_t t = 0; t < whole.triangles.size(); ++t) {
    const int x = static_cast<int>(t / 2) % n * tiles / n, y = static_cast<int>(t / 2) / n * tiles / n;
    auto& triangle = out.triangles.emplace_back();
    for (std::size_t k = 0; k < 3; ++k) {
      const std::uint32_t v = whole.triangles[t][k];
      const auto [at, is_new] =
          number.try_emplace({y * tiles + x, v}, static_cast<std::uint32_t>(out.positions.size()));
      if (is_new) out.positions.push_back(whole.positions[v] + Vec3d{off(random), off(random), off(random)});
      triangle[k] = at->second;
    }
  }
  return out;
}

struct Shape {
  std::size_t border_edges = 0, border_loops = 0, components = 0;
  bool operator==(const Shape&) const = default;
};

Shape shape_of(const GridMesh& mesh) {
  std::map<std::pair<std::uint32_t, std::uint32_t>, int> edges;
  std::vector<std::uint32_t> root(mesh.positions.size()), border_root;
  std::iota(root.begin(), root.end(), 0u);
  border_root = root;
  const auto find = [](std::vector<std::uint32_t>& of, std::uint32_t v) {
    while (of[v] != v) v = of[v] = of[of[v]];
    return v;
  };
  for (const auto& t : mesh.triangles)
    for (std::size_t k = 0; k < 3; ++k) {
      const std::uint32_t a = mesh.wedge_group[t[k]], b = mesh.wedge_group[t[(k + 1) % 3]];
      ++edges[std::minmax(a, b)];
      root[find(root, a)] = find(root, b);
    }
  Shape shape;
  std::set<std::uint32_t> components, loops, on_border;
  for (const auto& t : mesh.triangles) components.insert(find(root, mesh.wedge_group[t[0]]));
  for (const auto& [edge, count] : edges)
    if (count == 1) {
      ++shape.border_edges;
      border_root[find(border_root, edge.first)] = find(border_root, edge.second);
      on_border.insert(edge.first);
    }
  for (const std::uint32_t v : on_border) loops.insert(find(border_root, v));
  shape.border_loops = loops.size();
  shape.components = components.size();
  return shape;
}

/// The surface, however it is numbered.
std::vector<std::array<Vec3i, 3>> triangles_of(const GridMesh& m) {
  std::vector<std::array<Vec3i, 3>> out;
  for (const auto& t : m.triangles) {
    out.push_back({m.positions[t[0]], m.positions[t[1]], m.positions[t[2]]});
    std::rotate(out.back().begin(), std::min_element(out.back().begin(), out.back().end()), out.back().end());
  }
  std::sort(out.begin(), out.end());
  return out;
}

GridMesh cleaned(const SurfaceMesh& mesh, const CleanOptions& options, CleanReport* report = nullptr) {
  CleanReport ignored;
  auto out = clean_mesh(mesh, options, report ? *report : ignored);
  EXPECT_TRUE(out) << (out ? "" : out.error().text());
  if (!out) return {};
  EXPECT_EQ(find_violation(*out), "");
  return std::move(*out);
}

TEST(WeldBorders, CrackedTilesBecomeOneSurfaceWithOneBorder) {
  for (const int tiles : {2, 3}) {
    const int n = 24;
    const SurfaceMesh mesh = cracked_tiles(n, tiles, 0.02);
    CleanReport report;
    const Shape before = shape_of(cleaned(mesh, {.step = 1e-4, .chunk_triangles = 100}, &report));
    EXPECT_EQ(before.components, static_cast<std::size_t>(tiles * tiles));
    EXPECT_EQ(report.border_points + report.border_points_welded, 0u);
    const auto joined = cleaned(mesh, {.step = 1e-4, .chunk_triangles = 100, .weld_tolerance = 0.1}, &report);
    EXPECT_EQ(shape_of(joined), (Shape{static_cast<std::size_t>(4 * n), 1, 1}));
    EXPECT_EQ(joined.triangles.size(), mesh.triangles.size());
    EXPECT_EQ(joined.positions.size(), static_cast<std::size_t>((n + 1) * (n + 1)));
    EXPECT_EQ(report.border_points_welded, mesh.positions.size() - joined.positions.size());
    EXPECT_EQ(report.border_points, static_cast<std::size_t>(4 * n * tiles));
  }
}

/// The tolerance spans what lies between the points of both borders, which are not pairs.
TEST(WeldBorders, BordersOfUnlikePointsCloseWithinALargerTolerance) {
  SurfaceMesh left = wavy_patch(32), right = wavy_patch(32);
  for (Vec3d& p : left.positions) p = {p.x, p.y, 0};
  for (Vec3d& p : right.positions) p = {32.01 + p.x, p.y * (31.5 / 32) + 0.25, 0};
  const SurfaceMesh mesh = joined(left, right);
  EXPECT_EQ(shape_of(cleaned(mesh, {.step = 0.001})).components, 2u);
  const Shape shape = shape_of(cleaned(mesh, {.step = 0.001, .weld_tolerance = 1}));
  EXPECT_EQ(shape.components, 1u);
  EXPECT_EQ(shape.border_loops, 1u);
}

/// Open edges, moves and all from their definitions, on the mesh in memory.
SurfaceMesh welded_by_definition(SurfaceMesh mesh, const Grid& grid, double tolerance) {
  std::vector<Vec3i> points;
  for (const Vec3d& p : mesh.positions) points.push_back(grid.snap(p));
  std::map<std::set<Vec3i>, int> faces, edges;
  for (const auto& t : mesh.triangles) {
    const std::set<Vec3i> face{points[t[0]], points[t[1]], points[t[2]]};
    if (face.size() < 3 || faces[face]++ > 0) continue;
    for (std::size_t k = 0; k < 3; ++k) ++edges[{points[t[k]], points[t[(k + 1) % 3]]}];
  }
  std::vector<Vec3i> open;
  for (const auto& [edge, count] : edges)
    if (count == 1) open.insert(open.end(), edge.begin(), edge.end());
  const Moves moves = moves_by_definition(in_order(open), tolerance / grid.step);
  for (std::size_t v = 0; v < points.size(); ++v)
    if (const auto at = moves.find(points[v]); at != moves.end()) mesh.positions[v] = grid.world(at->second);
  return mesh;
}

/// Random triangles, many with common corners and some degenerate or twice, within far points that nothing
/// joins.
SurfaceMesh tangle(std::uint32_t seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> coordinate(2, 14);
  SurfaceMesh mesh;
  for (int i = 0; i < 120; ++i)
    mesh.positions.push_back({coordinate(random), coordinate(random), coordinate(random)});
  for (int i = 0; i < 250; ++i) {
    const auto any = [&] { return static_cast<std::uint32_t>(random() % mesh.positions.size()); };
    mesh.triangles.push_back({any(), any(), any()});
    if (i % 20 == 0) mesh.triangles.push_back(mesh.triangles.back());
  }
  return joined(joined(mesh, mesh_of({{0, 0, 0}, {0, 1, 0}, {0, 0, 1}}, {{0, 1, 2}})),
                mesh_of({{64, 64, 64}, {64, 60, 64}, {64, 64, 60}}, {{0, 1, 2}}));
}

TEST(WeldBorders, IsWhatTheMovedPointsGive) {
  int changed = 0;
  for (std::uint32_t seed = 0; seed < 12; ++seed) {
    const double tolerance = seed % 2 ? 0.9 : 0.4;
    const SurfaceMesh mesh = tangle(seed);
    const GridMesh as_is = cleaned(mesh, {.step = 0.01, .make_normals = false});
    const auto expected = triangles_of(
        cleaned(welded_by_definition(mesh, as_is.grid, tolerance), {.step = 0.01, .make_normals = false}));
    for (const std::uint32_t chunk : {5u, 40u, 100'000u}) {
      SCOPED_TRACE(std::to_string(seed) + " in chunks of " + std::to_string(chunk));
      const CleanOptions options{
          .step = 0.01, .make_normals = false, .chunk_triangles = chunk, .weld_tolerance = tolerance};
      EXPECT_TRUE(triangles_of(cleaned(mesh, options)) == expected);
    }
    changed += triangles_of(as_is) != expected;
  }
  EXPECT_GT(changed, 4);
}

bool same(const GridMesh& a, const GridMesh& b) {
  return a.positions == b.positions && a.normals == b.normals && a.wedge_group == b.wedge_group &&
         a.triangles == b.triangles;
}

TEST(WeldBorders, TheSameForAnyBlocksAndThreads) {
  const SurfaceMesh mesh = cracked_tiles(40, 4, 0.02);
  CleanOptions options{.chunk_triangles = 200, .weld_tolerance = 0.1};
  const GridMesh expected = cleaned(mesh, options);
  for (const int threads : {1, 2, 5})
    for (const std::uint64_t block : {7u, 300u, 100'000u}) {
      options.block_vertices = block;
      GridMesh found;
      tbb::task_arena(threads).execute([&] { found = cleaned(mesh, options); });
      EXPECT_TRUE(same(found, expected)) << threads << " " << block;
    }
}

Result<IngestedSurface> ingested(WorkFolder& folder, const SurfaceMesh& mesh, double tolerance,
                                 const BuildProgress& progress = {},
                                 std::uint64_t memory_bytes = test_memory) {
  MemoryBudget memory(memory_bytes);
  auto surface = ingest(
      folder, {.chunk_triangles = 200, .weld_tolerance = tolerance}, memory,
      [&](RawSurface& sink) { return feed(mesh, sink); }, progress);
  EXPECT_EQ(memory.used_bytes(), 0u);
  return surface;
}

TEST(WeldBorders, GoesOnFromWhereItWasStopped) {
  const SurfaceMesh mesh = cracked_tiles(40, 4, 0.02);
  const GridMesh expected = cleaned(mesh, {.chunk_triangles = 200, .weld_tolerance = 0.1});
  for (const std::string_view stage : {"sort", "weld", "clean"})
    for (const int calls : {1, 3, 20}) {
      SCOPED_TRACE(std::string(stage) + " " + std::to_string(calls));
      const ScratchFolder scratch;
      int called = 0, stops = 0;
      for (;;) {
        auto folder = WorkFolder::open(scratch / "work", "test");
        ASSERT_TRUE(folder);
        const auto surface =
            ingested(*folder, mesh, 0.1, [&](std::string_view s, std::uint64_t, std::uint64_t) {
              return s != stage || stops > 2 || ++called % calls != 0;
            });
        if (surface) {
          EXPECT_TRUE(same(put_together(*surface), expected));
          EXPECT_GT(surface->report.border_points_welded, 0u);
          for (const char* name : {"borders", "moves", "moved", "replaced"})
            EXPECT_FALSE(std::filesystem::exists(scratch / "work" / name)) << name;
          break;
        }
        ASSERT_EQ(surface.error().code, ErrorCode::cancelled);
        ++stops;
      }
    }
}

TEST(WeldBorders, TolerancesThatAreNoneAreRefused) {
  const double nan = std::numeric_limits<double>::quiet_NaN(), inf = std::numeric_limits<double>::infinity();
  const SurfaceMesh mesh = cracked_tiles(8, 2, 0.01);
  for (const double tolerance : {nan, inf, -inf, -1.0, -1e-300, 1.0, 1e300}) {
    const ScratchFolder scratch;
    auto folder = WorkFolder::open(scratch / "work", "test");
    ASSERT_TRUE(folder);
    const auto surface = ingested(*folder, mesh, tolerance);
    ASSERT_FALSE(surface) << tolerance;
    EXPECT_EQ(surface.error().code, ErrorCode::invalid_input);
    EXPECT_NE(surface.error().message.find("tolerance"), std::string::npos) << surface.error().text();
  }
  CleanReport report;
  EXPECT_TRUE(same(cleaned(mesh, {.weld_tolerance = 5e-324}, &report), cleaned(mesh, {})));
  EXPECT_EQ(report.border_points_welded, 0u);
}

TEST(WeldBorders, TooLittleMemoryIsToldBeforeItIsUsed) {
  const ScratchFolder scratch;
  auto folder = WorkFolder::open(scratch / "work", "test");
  ASSERT_TRUE(folder);
  const SurfaceMesh mesh = cracked_tiles(40, 4, 0.02);
  const auto stop = [](std::string_view s, std::uint64_t, std::uint64_t) { return s != "weld"; };
  EXPECT_FALSE(ingested(*folder, mesh, 0.1, stop));
  const auto surface = ingested(*folder, mesh, 0.1, {}, 50'000);
  ASSERT_FALSE(surface);
  EXPECT_EQ(surface.error().code, ErrorCode::out_of_budget);
  EXPECT_TRUE(ingested(*folder, mesh, 0.1));
}

/// An attribute that differs across the crack is a seam afterwards, not a border.
TEST(WeldBorders, AttributesStay) {
  SurfaceMesh mesh = cracked_tiles(16, 2, 0.02);
  for (const Vec3d& p : mesh.positions)
    mesh.colours.push_back(Rgba8{static_cast<std::uint8_t>(p.x < 8 ? 10 : 200), 0, 0, 255});
  CleanReport report;
  const GridMesh out = cleaned(mesh, {.chunk_triangles = 60, .weld_tolerance = 0.1}, &report);
  EXPECT_EQ(shape_of(out), (Shape{64, 1, 1}));
  EXPECT_GT(report.wedge_groups, 0u);
}

}  // namespace
}  // namespace cuesta
