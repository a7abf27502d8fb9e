// cuesta-bench-terrain guarantee FILE.cuesta RASTER… and baselines RASTER: triangles at errors in metres that
// are verified at every posting (apps/measure/vertical_error.h), of uniform cuts and of what others do.
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <limits>
#include <memory>

#include "apps/measure/vertical_error.h"
#include "runtime/cut.h"
#include "runtime/extract.h"
#include "tools/baselines/greedy_delaunay.h"
#include "tools/baselines/right_triangles.h"
#include "tools/bench/terrain_world.h"

namespace {

using namespace cuesta;
using bench::open_rasters, bench::Rasters, bench::TerrainWorld;

struct Settings {
  std::string file;  ///< .cuesta
  std::vector<std::string> rasters;
  std::vector<double> errors_m{5, 10, 20, 50};
  std::string csv;    ///< "": none
  std::string geoid;  ///< "": the one that the file names
};

/// What a cut is off at all postings, in three ways.
struct Found {
  std::uint64_t postings = 0;
  measure::VerticalDeviation exact;    ///< where they are, with as much slack as the grid moves them
  measure::VerticalDeviation on_grid;  ///< where the file's grid has them, at most its snap_error() away
  measure::VerticalDeviation beside;   ///< there, of those without surface above or below: a rim has moved
};

double clock_ms() {
  return std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now().time_since_epoch())
      .count();
}

/// A printed table that is a CSV file too, and whether what it says is good.
class Table {
 public:
  static Result<Table> create(const std::string& csv) {
    Table table;
    if (!csv.empty()) table.csv_.reset(std::fopen(csv.c_str(), "w"));
    if (!csv.empty() && !table.csv_) return fail(ErrorCode::io, csv, "", "cannot be written");
    table.write(
        "method,error_m,reported_m,triangles,postings,max_m,p999_m,uncovered,beyond,snap_m,max_on_grid_m,"
        "uncovered_on_grid,beyond_on_grid,beside_max_m,lost_beside,beyond_beside,seconds");
    return table;
  }

  /// @param reported_m  what the method itself says of its error.
  void add(const char* method, double error_m, double reported_m, std::size_t triangles, const Found& found,
           double snap_m, double seconds) {
    const measure::VerticalDeviation &exact = found.exact, &grid = found.on_grid;
    write(fmt::format("{},{:g},{:.6g},{},{},{:.6g},{:.6g},{},{},{:.4g},{:.6g},{},{},{:.6g},{},{},{:.2f}",
                      method, error_m, reported_m, triangles, found.postings, exact.max_m, exact.p999_m,
                      exact.uncovered, exact.beyond, snap_m, grid.max_m, grid.uncovered, grid.beyond,
                      found.beside.max_m, found.beside.uncovered, found.beside.beyond, seconds));
    beyond_ += exact.beyond + grid.beyond + found.beside.uncovered + found.beside.beyond;
  }
  std::uint64_t beyond() const { return beyond_; }

 private:
  void write(const std::string& line) {
    fmt::print("{}\n", line);
    std::fflush(stdout);
    if (csv_) fmt::print(csv_.get(), "{}\n", line);
  }
  struct Close {
    void operator()(std::FILE* file) const { std::fclose(file); }
  };
  std::unique_ptr<std::FILE, Close> csv_;
  std::uint64_t beyond_ = 0;
};

void add_to(measure::VerticalDeviation& all, const measure::VerticalDeviation& some) {
  all.uncovered += some.uncovered;
  all.beyond += some.beyond;
  all.max_m = std::max(all.max_m, some.max_m);
  all.p999_m = std::max(all.p999_m, some.p999_m);
}

/// Errors are rounded up to f32.
double rounded_up(double error_m) {
  return error_m * (1 + 1e-6);
}

/// Those that have a height.
std::vector<Vec3d> snapped(std::span<const Vec3d> postings_m, const Grid& grid) {
  std::vector<Vec3d> out;
  for (const Vec3d& p : postings_m)
    if (std::isfinite(p.x + p.y + p.z)) out.push_back(grid.world(grid.snap(p)));
  return out;
}

/// Of all postings; the 99.9 percentile is the largest of those of some millions each.
/// @param grid  of the file; null: nothing is snapped, and no rim moves
Result<Found> check(const SurfaceMesh& mesh, const TerrainWorld& world, double error_m, const Grid* grid) {
  Found all;
  const double snap_m = grid ? grid->snap_error() : 0, bound_m = rounded_up(error_m);
  const auto done = world.visit_postings([&](std::span<const Vec3d> postings) {
    const auto vertical = [&](std::span<const Vec3d> at, double most_m, double slack_m, double rim_m) {
      return measure::vertical_error(
          mesh, at, {.up = world.up(), .bound_m = most_m, .slack_m = slack_m, .rim_m = rim_m});
    };
    const measure::VerticalError exact = vertical(postings, bound_m + snap_m, snap_m, 0);
    all.postings += exact.postings;
    add_to(all.exact, exact.with_slack);
    if (!grid) return add_to(all.on_grid, exact.exact);
    const measure::VerticalError on_grid = vertical(snapped(postings, *grid), bound_m, 0, bound_m);
    add_to(all.on_grid, on_grid.exact);
    add_to(all.beside, on_grid.beside);
  });
  if (!done) return fail(done.error());
  return all;
}

/// Uniform cuts of the errors asked for.
Result<void> check_cuts(const Settings& s, Table& table) {
  const auto rasters = open_rasters(s.rasters);
  if (!rasters) return fail(rasters.error());
  auto file = CuestaFile::open(s.file);
  if (!file) return fail(file.error());
  const auto cut = Cut::open(std::move(*file), std::numeric_limits<std::uint64_t>::max(), clock_ms);
  if (!cut) return fail(cut.error());
  const Directory& d = (*cut)->directory();
  const auto world = TerrainWorld::of(d.metadata, *rasters, s.geoid);
  if (!world) return fail(world.error());
  const ErrorScale scale = ErrorScale::uniform(d.grid);
  const double snap_m = d.grid.snap_error();
  for (const double error_m : s.errors_m) {
    const double start_ms = clock_ms();
    const AdaptReport report = (*cut)->settle(scale, error_m, {});
    if (const auto errors = (*cut)->cache().errors(); !errors.empty()) return fail(errors.front());
    const auto mesh = extract_mesh((*cut)->draw_list(), {false, false});
    if (!mesh) return fail(mesh.error());
    const double seconds = (clock_ms() - start_ms) / 1000;
    const auto found = check(*mesh, *world, error_m, &d.grid);
    if (!found) return fail(found.error());
    table.add("cuesta", error_m, report.achieved, mesh->triangles.size(), *found, snap_m, seconds);
  }
  return {};
}

/// A raster that the baselines can take: in memory, without holes.
struct Field {
  std::vector<float> heights_m;
  baselines::HeightGrid grid;
};

Result<Field> field_of(const HeightRaster& raster) {
  const RasterInfo& info = raster.info();
  constexpr std::uint64_t most = baselines::most_columns_or_rows;
  if (info.width < 2 || info.height < 2 || info.width > most || info.height > most)
    return fail(ErrorCode::invalid_input, info.files.front(), "",
                fmt::format("the baselines take 2 to {} postings a side, found {} x {}", most, info.width,
                            info.height));
  std::vector<double> heights_m(info.width * info.height);
  if (auto r = raster.read({0, 0, info.width, info.height}, heights_m); !r) return fail(r.error());
  Field field;
  for (const double h : heights_m) {
    if (std::isnan(h))
      return fail(ErrorCode::invalid_input, info.files.front(), "",
                  "the baselines take no postings without data");
    field.heights_m.push_back(static_cast<float>(h));
  }
  field.grid = {static_cast<std::uint32_t>(info.width), static_cast<std::uint32_t>(info.height),
                field.heights_m};
  return field;
}

Result<void> run_baselines(const Settings& s, Table& table) {
  const auto rasters = open_rasters(s.rasters);
  if (!rasters) return fail(rasters.error());
  const auto field = field_of(*rasters->front());
  if (!field) return fail(field.error());
  const TerrainWorld world = TerrainWorld::plane(*rasters);
  SurfaceMesh mesh;
  const auto positions = world.visit_postings([&](std::span<const Vec3d> postings) {
    mesh.positions.insert(mesh.positions.end(), postings.begin(), postings.end());
  });
  if (!positions) return positions;
  const auto add = [&](const char* method, double error_m, double seconds) -> Result<void> {
    const auto found = check(mesh, world, error_m, nullptr);
    if (!found) return fail(found.error());
    table.add(method, error_m, error_m, mesh.triangles.size(), *found, 0, seconds);
    return {};
  };
  for (const double error_m : s.errors_m) {
    const double start_ms = clock_ms();
    mesh.triangles = baselines::greedy_delaunay(field->grid, error_m);
    if (auto r = add("delaunay", error_m, (clock_ms() - start_ms) / 1000); !r) return r;
  }
  if (!baselines::RightTriangles::takes(field->grid.columns, field->grid.rows)) return {};
  double start_ms = clock_ms();
  const baselines::RightTriangles tree(field->grid);
  for (const double error_m : s.errors_m) {
    mesh.triangles = tree.cut(error_m);
    if (auto r = add("right_triangles", error_m, (clock_ms() - start_ms) / 1000); !r) return r;
    start_ms = clock_ms();
  }
  return {};
}

int run(const Settings& s, Result<void> (*work)(const Settings&, Table&)) {
  auto table = Table::create(s.csv);
  const Result<void> done = table ? work(s, *table) : Result<void>(fail(table.error()));
  if (!done) {
    fmt::print(stderr, "cuesta-bench-terrain: {}\n", done.error().text());
    return exit_status(done.error().code);
  }
  return table->beyond() == 0 ? 0 : 1;
}

}  // namespace

int main(int argc, char** argv) {
  Settings s;
  CLI::App app{
      "Triangles of terrain at errors that are verified at every posting. Exit status 1: one is beyond.",
      "cuesta-bench-terrain"};
  app.require_subcommand(1);
  CLI::App* guarantee = app.add_subcommand("guarantee", "uniform cuts of a .cuesta file");
  guarantee->add_option("FILE", s.file, ".cuesta that was built from the rasters")->required();
  guarantee->add_option("--geoid", s.geoid,
                        "where heights must be converted; default: the one that FILE names");
  CLI::App* others =
      app.add_subcommand("baselines", "greedy Delaunay insertion, right triangles if sides are 2^k + 1");
  for (CLI::App* command : {guarantee, others}) {
    auto* rasters =
        command->add_option("RASTER", s.rasters, "heights; a JSON sidecar may place them")->required();
    if (command == others) rasters->expected(1);
    command->add_option("--errors", s.errors_m, "vertical errors in metres, 5,10,20,50 by default")
        ->delimiter(',');
    command->add_option("--csv", s.csv, "file for the table");
  }
  CLI11_PARSE(app, argc, argv);
  return run(s, guarantee->parsed() ? check_cuts : run_baselines);
}
