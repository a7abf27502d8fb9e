/// Whole builds of small terrains in all frames: errors are guaranteed over every posting, and nothing but
/// the postings and options decides about the bytes.

#include <tbb/global_control.h>
#include <tbb/task_arena.h>

#include <map>

#include "apps/measure/vertical_error.h"
#include "hierarchy/verify_file.h"
#include "runtime/extract.h"
#include "tests/runtime/open_file.h"
#include "tests/terrain/small_terrains.h"

namespace cuesta {
namespace {

using test::SmallTerrain;
using test::TemporaryFolder;

/// Bumps on a flat sea with a few voids: coarse triangles stand for hundreds of postings.
std::vector<double> sea_with_islands(std::uint64_t width, std::uint64_t height, double voids) {
  std::mt19937 random(5);
  std::vector<double> out;
  for (std::uint64_t i = 0; i < width * height; ++i) {
    const double x = double(i % width) / double(width), y = double(i / width) / double(height);
    const double island = 0.25 - std::hypot(x - 0.7, y - 0.35);
    double h = island > 0 ? std::round(island * (400 + 90 * std::sin(40 * x) * std::cos(31 * y))) : 0;
    if (random() % 700 == 0) h += 3;  // ships
    if (std::hypot(x - 0.2, y - 0.2) < voids) h = test::none;
    out.push_back(h);
  }
  return out;
}

std::vector<SmallTerrain> terrains() {
  const Frame plane = Frame::projected(Crs::plane()).value();
  const std::string degrees_grid = test::grid(6.9, 46.1, 0.002, 100, sea_with_islands(100, 90, 0.08));
  const std::string fine = test::grid(6.96, 46.03, 0.0007, 60, sea_with_islands(60, 60, 0.05));
  std::vector<SmallTerrain> all;
  all.push_back(
      {"plane", {{"a.asc", test::grid(0, 3000, 30, 110, sea_with_islands(110, 95, 0.1))}}, plane, {}});
  for (const Frame& frame : {Frame::ecef(), test::frame_at(46, 7)})
    all.push_back({frame.description(), {{"a.asc", degrees_grid}, {"b.asc", fine}}, frame, test::degrees()});
  all.push_back({"the Earth",
                 {{"a.asc", test::grid(-180, 90, 3, 120, sea_with_islands(120, 61, 0.06))}},
                 Frame::ecef(),
                 test::degrees()});
  return all;
}

BuildOptions small_cells() {
  BuildOptions options;
  options.cell_triangles = 700;
  return options;
}

/// How a build may differ from another of the same postings.
struct Run {
  int threads = 2;
  std::uint64_t memory_bytes = std::uint64_t{1} << 30;
  BuildProgress progress = {};
};

/// Surveys and builds `folder / name`, in a work folder beside it.
Result<BuildReport> try_build(const SmallTerrain& terrain, const TemporaryFolder& folder,
                              const std::string& name, const Run& run = {}) {
  test::Paths paths;
  for (const auto& [file, text] : terrain.files) {
    test::put_bytes(folder / file, text);
    paths.push_back(folder / file);
  }
  const auto mosaic = test::open_mosaic(paths, terrain.options);
  auto work = WorkFolder::open(folder / (name + ".work"), terrain.name);
  if (!work) return fail(work.error());
  MemoryBudget memory(run.memory_bytes);
  const tbb::global_control threads(tbb::global_control::max_allowed_parallelism, std::size_t(run.threads));
  return tbb::task_arena(run.threads).execute([&]() -> Result<BuildReport> {
    const auto surface =
        TerrainSurface::survey(*mosaic, terrain.frame, {.square_side = 32}, *work, memory, run.progress);
    if (!surface) return fail(surface.error());
    auto report = build_hierarchy(**surface, folder / name, small_cells(), *work, memory, run.progress);
    if (report) work->remove();
    return report;
  });
}

void build(const SmallTerrain& terrain, const TemporaryFolder& folder, const std::string& name,
           const Run& run = {}) {
  const auto built = try_build(terrain, folder, name, run);
  ASSERT_TRUE(built) << built.error().text();
}

/// Postings that are corners of a triangle at full resolution: lone ones are no surface.
std::vector<Vec3d> postings_of(const SmallTerrain& terrain, const SurfaceMesh& full, double snap_m) {
  const test::Surveyed surveyed(terrain);
  std::map<std::array<std::int64_t, 3>, bool> corners;
  const double cell_m = 4 * snap_m;
  const auto key = [&](Vec3d p, int dx, int dy, int dz) {
    return std::array{std::int64_t(std::floor(p.x / cell_m)) + dx,
                      std::int64_t(std::floor(p.y / cell_m)) + dy,
                      std::int64_t(std::floor(p.z / cell_m)) + dz};
  };
  for (const Vec3d& p : full.positions)
    for (int n = 0; n < 27; ++n) corners[key(p, n % 3 - 1, n / 3 % 3 - 1, n / 9 - 1)] = true;
  std::vector<Vec3d> out;
  for (std::uint32_t l = 0; l < surveyed.mosaic().layers().size(); ++l)
    for (const Vec3d& p : surveyed.positions_m(l))
      if (test::is_place(p) && corners.contains(key(p, 0, 0, 0))) out.push_back(p);
  return out;
}

std::vector<Vec3d> snapped(const std::vector<Vec3d>& postings_m, const Grid& grid) {
  std::vector<Vec3d> out;
  for (const Vec3d& p : postings_m) out.push_back(grid.world(grid.snap(p)));
  return out;
}

SurfaceMesh cut_at(Cut& cut, double bound_m) {
  cut.settle(ErrorScale::uniform(cut.directory().grid), bound_m, {});
  EXPECT_TRUE(cut.cache().errors().empty());
  return extract_mesh(cut.draw_list()).value();
}

TEST(TerrainBuild, every_posting_is_within_the_bound_of_any_cut) {
  for (const SmallTerrain& terrain : terrains()) {
    SCOPED_TRACE(terrain.name);
    const TemporaryFolder folder;
    build(terrain, folder, "a.cuesta");
    if (HasFailure()) return;
    const auto cut = test::open_cut(folder / "a.cuesta");
    ASSERT_TRUE(cut);
    EXPECT_GE(cut->directory().pages.back().round, 2u);
    const double snap_m = cut->directory().grid.snap_error();
    const SurfaceMesh full = cut_at(*cut, -1);
    const std::vector<Vec3d> postings = postings_of(terrain, full, snap_m);
    EXPECT_GE(postings.size(), full.positions.size());  // at a pole many are one vertex
    const bool is_plane = terrain.frame.kind() == FrameKind::projected;
    const Frame& frame = terrain.frame;
    std::size_t triangles = full.triangles.size();
    for (const double bound_m : {0.0, 1.0, 4.0, 15.0, 60.0, 1e9}) {
      const SurfaceMesh mesh = cut_at(*cut, bound_m);
      EXPECT_LE(mesh.triangles.size(), triangles) << bound_m;
      triangles = mesh.triangles.size();
      if (bound_m > 1e6) continue;  // a rim may have moved
      measure::VerticalOptions options{.bound_m = bound_m + snap_m, .slack_m = snap_m};
      if (!is_plane) options.up = [&frame](Vec3d p) { return frame.up(p); };
      const auto error = measure::vertical_error(mesh, postings, options);
      EXPECT_EQ(error.with_slack.beyond, 0u) << bound_m << ": " << error.with_slack.max_m;
      // Where the grid has them, and beside rims that have moved.
      options.rim_m = options.bound_m = bound_m * (1 + 1e-6) + 1e-6;
      const auto on_grid = measure::vertical_error(mesh, snapped(postings, cut->directory().grid), options);
      EXPECT_EQ(on_grid.exact.beyond, 0u) << bound_m << ": " << on_grid.exact.max_m;
      EXPECT_EQ(on_grid.beside.beyond, 0u) << bound_m << ": " << on_grid.beside.max_m;
      EXPECT_EQ(on_grid.beside.uncovered, 0u) << bound_m;
    }
    EXPECT_LT(triangles, full.triangles.size() / 20);
  }
}

/// Whole metres, postings a metre apart: a grid of whole metres would be no finer than the lattice.
TEST(TerrainBuild, steep_whole_heights_near_to_each_other_become_small) {
  constexpr int side = 65;
  std::vector<double> heights;
  for (int i = 0; i < side * side; ++i)
    heights.push_back(std::round(900 * std::sin(0.11 * (i % side)) * std::cos(0.07 * (i / side))));
  const SmallTerrain terrain{
      "steep", {{"a.i16", test::packed<std::int16_t>(heights)}}, Frame::projected(Crs::plane()).value(), {}};
  const TemporaryFolder folder;
  const auto built = try_build(terrain, folder, "steep.cuesta");
  ASSERT_TRUE(built) << built.error().text();
  EXPECT_GT(built->substitutions, side * side * 9 / 10);
}

TEST(TerrainBuild, files_verify) {
  for (const SmallTerrain& terrain : terrains()) {
    SCOPED_TRACE(terrain.name);
    const TemporaryFolder folder;
    build(terrain, folder, "a.cuesta");
    const auto file = CuestaFile::open(folder / "a.cuesta");
    ASSERT_TRUE(file);
    const auto report = verify_file(*file);
    ASSERT_TRUE(report);
    EXPECT_TRUE(report->ok()) << report->findings.front().text;
  }
}

TEST(TerrainBuild, same_bytes_for_any_threads_and_memory) {
  for (const SmallTerrain& terrain : terrains()) {
    SCOPED_TRACE(terrain.name);
    const TemporaryFolder folder;
    build(terrain, folder, "a.cuesta");
    const std::string expected = test::bytes_of(folder / "a.cuesta");
    ASSERT_FALSE(expected.empty());
    build(terrain, folder, "b.cuesta", {.threads = 1});
    EXPECT_TRUE(test::bytes_of(folder / "b.cuesta") == expected) << "one thread";
    build(terrain, folder, "c.cuesta", {.threads = 4, .memory_bytes = std::uint64_t{100} << 20});
    EXPECT_TRUE(test::bytes_of(folder / "c.cuesta") == expected) << "four threads, little memory";
  }
}

/// Stops at every few reports of progress, and goes on.
TEST(TerrainBuild, same_bytes_after_interruptions) {
  for (const SmallTerrain& terrain : terrains()) {
    SCOPED_TRACE(terrain.name);
    const TemporaryFolder folder;
    build(terrain, folder, "a.cuesta");
    const std::string expected = test::bytes_of(folder / "a.cuesta");
    for (const int patience : {1, 9}) {
      int runs = 0;
      for (bool done = false; !done; ++runs) {
        ASSERT_LT(runs, 400);
        int calls = 0;
        const auto built = try_build(terrain, folder, "b.cuesta",
                                     {.progress = [&](std::string_view, std::uint64_t, std::uint64_t) {
                                       return ++calls <= patience;
                                     }});
        done = built.has_value();
        if (!done) {
          ASSERT_EQ(built.error().code, ErrorCode::cancelled) << built.error().text();
        }
      }
      EXPECT_GT(runs, 1);
      EXPECT_TRUE(test::bytes_of(folder / "b.cuesta") == expected) << patience;
    }
  }
}

}  // namespace
}  // namespace cuesta
