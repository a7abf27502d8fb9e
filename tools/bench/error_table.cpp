// cuesta-bench-errors ORIGINAL FILE.cuesta [CSV]: what the reported errors are worth (I5), and triangles
// against measured screen error. Every original vertex is measured against every cut; nothing is sampled.
#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <limits>
#include <memory>

#include "apps/measure/screen_error.h"
#include "apps/measure/surface_distance.h"
#include "ooc/mesh_reader.h"
#include "runtime/cut.h"
#include "runtime/extract.h"

namespace {

using namespace cuesta;

double clock_ms() {
  return std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now().time_since_epoch())
      .count();
}

/// The file under test, its original, and a printed table that is a CSV file too.
struct Bench {
  SurfaceMesh original;
  std::unique_ptr<Cut> cut;
  double diagonal = 0;
  std::FILE* csv = nullptr;
  std::vector<double> ratios;
  std::uint64_t beyond = 0;  ///< original vertices farther away than reported, over all cuts
};

double median(std::vector<double> v) {
  std::sort(v.begin(), v.end());
  return v.empty() ? 0 : v[v.size() / 2];
}

void row(Bench& bench, const std::string& line, double bound, double largest, std::uint64_t beyond) {
  bench.ratios.push_back(largest > 0 ? bound / largest : 1);
  bench.beyond += beyond;
  fmt::print("{}\n", line);
  if (bench.csv) fmt::print(bench.csv, "{}\n", line);
}

std::uint64_t count_beyond(const std::vector<double>& values, double bound) {
  return static_cast<std::uint64_t>(
      std::count_if(values.begin(), values.end(), [bound](double d) { return d > bound; }));
}

/// Cuts at falling shares of the triangles; bound and distances in % of the diagonal.
bool uniform_cuts(Bench& bench) {
  const Directory& d = bench.cut->directory();
  const ErrorScale scale = ErrorScale::uniform(d.grid);
  row(bench, "cut,parameter,triangles,bound,measured_max,measured_p999,bound/max,vertices_beyond", 1, 1, 0);
  for (const double share : {0.5, 0.25, 0.1, 0.05, 0.02, 0.01, 0.005}) {
    Budgets budgets;
    budgets.triangles = static_cast<std::uint64_t>(share * static_cast<double>(d.triangles));
    const AdaptReport report = bench.cut->settle(scale, 0, budgets);
    const auto mesh = extract_mesh(bench.cut->draw_list());
    if (!mesh) return false;
    const auto measured = measure::vertex_distance(bench.original, measure::make_tree(*mesh));
    const double bound = report.achieved + d.grid.snap_error();
    const double percent = 100 / bench.diagonal;
    const std::uint64_t beyond = count_beyond(measured.distances, bound);
    row(bench,
        fmt::format("uniform,{},{},{:.5f},{:.5f},{:.5f},{:.3f},{}", share, report.triangles, bound * percent,
                    measured.percentiles.max * percent, measured.percentiles.p999 * percent,
                    bound / measured.percentiles.max, beyond),
        bound, measured.percentiles.max, beyond);
  }
  return true;
}

/// A camera over the point of the surface that is farthest towards +z near the middle, looking down on it;
/// from afar, at the whole.
View camera(const Bench& bench, double distance) {
  Box3d box;
  for (const Vec3d& p : bench.original.positions) box.add(p);
  const Vec3d centre = (box.lo + box.hi) * 0.5;
  Vec3d top = centre;
  double best = std::numeric_limits<double>::lowest();
  for (const Vec3d& p : bench.original.positions) {
    const double height = p.z - 2 * (std::abs(p.x - centre.x) + std::abs(p.y - centre.y));
    if (height > best) {
      best = height;
      top = p;
    }
  }
  View view;
  view.width_px = 1920;
  view.height_px = 1080;
  view.target = distance > 1 ? centre : top;
  view.eye = view.target + Vec3d{0, 0, distance * bench.diagonal};
  return view;
}

/// Three distances, several tau; all errors in pixels, over all vertices wherever they are.
bool view_cuts(Bench& bench) {
  const Directory& d = bench.cut->directory();
  for (const double distance : {0.01, 0.1, 1.1}) {
    const View view = camera(bench, distance);
    for (const double tau : {0.5, 1.0, 1.5, 2.0, 3.0}) {
      const ErrorScale scale = ErrorScale::perspective(d.grid, view);
      const AdaptReport report = bench.cut->settle(scale, tau, {});
      const auto mesh = extract_mesh(bench.cut->draw_list());
      if (!mesh) return false;
      const auto distances = measure::point_distances(bench.original.positions, measure::make_tree(*mesh));
      const auto error =
          measure::screen_error(bench.original.positions, distances, view, measure::Region::everywhere);
      const auto pixels_at = [&](std::size_t i) {
        return view.pixels_per_unit() / length(bench.original.positions[i] - view.eye);
      };
      const double bound = report.achieved + d.grid.snap_error() * pixels_at(error.worst);
      std::uint64_t beyond = 0;
      for (std::size_t i = 0; i < distances.size(); ++i)
        beyond += distances[i] * pixels_at(i) > report.achieved + d.grid.snap_error() * pixels_at(i);
      row(bench,
          fmt::format("view {:.2f},{},{},{:.3f},{:.3f},{:.3f},{:.3f},{}", distance, tau, report.triangles,
                      bound, error.px.max, error.px.p999, bound / error.px.max, beyond),
          bound, error.px.max, beyond);
    }
  }
  return true;
}

/// Vertices that no triangle uses are not part of the surface.
void drop_unused_vertices(SurfaceMesh& mesh) {
  std::vector<std::uint32_t> number(mesh.positions.size(), 0xFFFFFFFFu);
  std::vector<Vec3d> used;
  for (auto& t : mesh.triangles)
    for (std::uint32_t& v : t) {
      if (number[v] == 0xFFFFFFFFu) {
        number[v] = static_cast<std::uint32_t>(used.size());
        used.push_back(mesh.positions[v]);
      }
      v = number[v];
    }
  mesh = {std::move(used), {}, {}, {}, std::move(mesh.triangles)};
}

int run(const char* original, const char* file, const char* csv) {
  Bench bench;
  auto mesh = load_mesh(original, std::uint64_t{1} << 34);
  if (!mesh) return std::fprintf(stderr, "%s\n", mesh.error().text().c_str()), exit_status(mesh.error().code);
  bench.original = std::move(*mesh);
  drop_unused_vertices(bench.original);
  bench.diagonal = measure::bounding_diagonal(bench.original);
  auto opened = CuestaFile::open(file);
  if (!opened)
    return std::fprintf(stderr, "%s\n", opened.error().text().c_str()), exit_status(opened.error().code);
  auto cut = Cut::open(std::move(*opened), std::numeric_limits<std::uint64_t>::max(), clock_ms);
  if (!cut) return std::fprintf(stderr, "%s\n", cut.error().text().c_str()), exit_status(cut.error().code);
  bench.cut = std::move(*cut);
  const std::unique_ptr<std::FILE, int (*)(std::FILE*)> out(csv ? std::fopen(csv, "w") : nullptr,
                                                            std::fclose);
  bench.csv = out.get();
  if (!uniform_cuts(bench) || !view_cuts(bench)) return 1;
  fmt::print("median bound/max over {} cuts: {:.3f}; vertices beyond a bound: {}\n", bench.ratios.size() - 1,
             median({bench.ratios.begin() + 1, bench.ratios.end()}), bench.beyond);
  return bench.beyond == 0 ? 0 : 1;
}

}  // namespace

int main(int argc, char** argv) {
  if (argc < 3 || argc > 4) {
    std::fprintf(stderr, "usage: cuesta-bench-errors ORIGINAL FILE.cuesta [CSV]\n");
    return 1;
  }
  return run(argv[1], argv[2], argc == 4 ? argv[3] : nullptr);
}
