// cuesta-bench-strips run NAME MESH FOLDER: tables 1 to 4 of the strips' paper, of one model: multiresolution
// strips, as
//   the paper has them and with bands and dynamic length, against a progressive mesh (PM) and multiresolution
//   triangle strips (MTS), over the same total order. Appends to FOLDER/strips_*.csv.
// cuesta-bench-strips design MESH: what decided bands, dynamic length and which edges strips cross; to
// standard output. cuesta-bench-strips plot FOLDER: FOLDER/strips.svg.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <ctime>
#include <filesystem>
#include <fstream>
#include <functional>
#include <limits>
#include <map>
#include <string>

#include "apps/measure/surface_distance.h"
#include "apps/plot/svg_plot.h"
#include "hierarchy/build_strips.h"
#include "hierarchy/build_tom.h"
#include "hierarchy/strip_sides.h"
#include "ooc/mesh_reader.h"
#include "tools/baselines/mts.h"
#include "tools/baselines/progressive_mesh.h"
#include "tools/bench/csv_rows.h"
#include "tools/bench/total_order.h"

namespace {

using namespace cuesta;
using bench::TotalOrder;

constexpr int steps = 500;  // resolutions of a test
constexpr int runs = 5;     // of which the median counts
constexpr double one_band = std::numeric_limits<double>::infinity();
/// Of 8, 16, 32, 64 and any: the quickest for MTS in the linear test on the bunny.
constexpr std::uint32_t mts_longest = 32;

/// Processor time of this thread: what the work costs on one core, whatever else the machine does.
double thread_ms() {
  timespec t{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &t);
  return static_cast<double>(t.tv_sec) * 1e3 + static_cast<double>(t.tv_nsec) * 1e-6;
}

double median(std::vector<double> v) {
  std::nth_element(v.begin(), v.begin() + static_cast<std::ptrdiff_t>(v.size() / 2), v.end());
  return v[v.size() / 2];
}

/// A structure under test.
struct Model {
  std::string name;
  std::function<void(std::uint32_t)> set_resolution;
  std::function<std::size_t(std::span<std::uint32_t>)> write_indices;
  std::uint64_t bytes = 0;
  std::uint32_t base = 0;
};

template <class Mesh>
Model model_of(std::string name, Mesh& mesh, std::uint32_t base) {
  return {std::move(name), [&](std::uint32_t r) { mesh.set_resolution(r); },
          [&](std::span<std::uint32_t> out) { return mesh.write_indices(out); }, mesh.bytes(), base};
}

/// Of a test: means over its resolutions.
struct Cost {
  double recovery_ms = 0, indices_ms = 0, vertices_ms = 0, indices = 0, sent = 0;
};

/// What becomes of a mesh when it is drawn: a list of indices, and a list of vertices as in immediate mode.
class Drawing {
 public:
  explicit Drawing(const TotalOrder& order) : indices_(order.triangles.size() * 5 + 64) {
    for (const Vec3d& p : order.positions) positions_.push_back(vec_cast<float>(p));
    vertices_.resize(indices_.size());
  }
  std::size_t list_indices(const Model& model) { return model.write_indices(indices_); }
  /// @return how many vertices the first `count` indices send.
  std::size_t list_vertices(std::size_t count) {
    std::size_t sent = 0;
    for (const std::uint32_t v : std::span(indices_).first(count)) {
      if (v == strip_restart) continue;
      vertices_[sent++] = positions_[v];
    }
    return sent;
  }

 private:
  std::vector<std::uint32_t> indices_;
  std::vector<Vec3f> positions_, vertices_;
};

using Test = std::vector<std::uint32_t>;  // resolutions

/// From the finest to the coarsest, in equal steps.
Test linear_test(std::uint32_t finest, std::uint32_t coarsest) {
  Test test;
  for (int i = 0; i <= steps; ++i)
    test.push_back(finest -
                   static_cast<std::uint32_t>(std::lround((finest - coarsest) * (i / double{steps}))));
  return test;
}

/// Great leaps first, then smaller ones, by the same factor each; 40 times smaller at the end than at the
/// beginning, which gives PM the ratio to the linear test that it has in the paper. Towards the finest, as
/// there, or the coarsest.
Test exponential_test(std::uint32_t finest, std::uint32_t coarsest, bool to_finest) {
  Test test;
  for (int i = 0; i <= steps; ++i) {
    const auto far =
        static_cast<std::uint32_t>(std::lround((finest - coarsest) * std::pow(40.0, -i / double{steps})));
    test.push_back(to_finest ? finest - far : coarsest + far);
  }
  return test;
}

/// The test three times, each time with one more thing done; what that takes more is its time.
Cost run_once(const Model& model, const Test& test, Drawing& drawing) {
  Cost sum;
  const double start = thread_ms();
  for (const std::uint32_t r : test) model.set_resolution(r);
  const double recovered = thread_ms();
  for (const std::uint32_t r : test) {
    model.set_resolution(r);
    sum.indices += static_cast<double>(drawing.list_indices(model));
  }
  const double listed = thread_ms();
  for (const std::uint32_t r : test) {
    model.set_resolution(r);
    sum.sent += static_cast<double>(drawing.list_vertices(drawing.list_indices(model)));
  }
  sum.vertices_ms = thread_ms() - listed - (listed - recovered);
  sum.indices_ms = listed - recovered - (recovered - start);
  sum.recovery_ms = recovered - start;
  for (double* v : {&sum.recovery_ms, &sum.indices_ms, &sum.vertices_ms, &sum.indices, &sum.sent})
    *v /= static_cast<double>(test.size());
  return sum;
}

/// All models in turn, run by run; medians of times.
std::vector<Cost> compare(const std::vector<Model>& models, const Test& test, Drawing& drawing) {
  std::vector<std::vector<Cost>> all(models.size());
  for (int r = 0; r < runs; ++r)
    for (std::size_t m = 0; m < models.size(); ++m) all[m].push_back(run_once(models[m], test, drawing));
  std::vector<Cost> costs;
  for (const auto& of_model : all) {
    Cost cost = of_model.back();
    for (double Cost::*ms : {&Cost::recovery_ms, &Cost::indices_ms, &Cost::vertices_ms}) {
      std::vector<double> times;
      for (const Cost& c : of_model) times.push_back(c.*ms);
      cost.*ms = median(std::move(times));
    }
    costs.push_back(cost);
  }
  return costs;
}

class CsvFile {
 public:
  CsvFile(const std::filesystem::path& path, const char* head) : out_(path, std::ios::app) {
    if (std::filesystem::file_size(path) == 0) out_ << head << '\n';
  }
  void row(const std::string& line) {
    out_ << line << '\n';
    fmt::print("{}\n", line);
    std::fflush(stdout);
  }

 private:
  std::ofstream out_;
};

std::uint32_t triangles_at(const TotalOrder& order, std::uint32_t r) {
  std::uint32_t count = 0;
  for (Triangle t : order.triangles) {
    for (std::uint32_t& v : t)
      while (v >= r) v = order.substitute[v];
    count += !is_degenerate(t);
  }
  return count;
}

void write_tests(const std::string& name, const std::filesystem::path& folder,
                 const std::vector<Model>& models, std::uint32_t finest, std::uint32_t coarsest,
                 Drawing& drawing) {
  CsvFile csv(folder / "strips_tests.csv",
              "mesh,test,model,recovery_ms,indices_ms,vertices_ms,recovery_share_of_indices,"
              "recovery_share_of_vertices,indices,vertices_sent,indices_per_triangle");
  const std::pair<const char*, Test> tests[] = {
      {"linear", linear_test(finest, coarsest)},
      {"exponential", exponential_test(finest, coarsest, true)},
      {"exponential to the coarsest", exponential_test(finest, coarsest, false)}};
  for (const auto& [test_name, test] : tests) {
    const auto costs = compare(models, test, drawing);
    const double triangles = costs[0].indices / 3;  // PM's
    for (std::size_t m = 0; m < models.size(); ++m) {
      const Cost& c = costs[m];
      csv.row(fmt::format("{},{},{},{:.5f},{:.5f},{:.5f},{:.3f},{:.3f},{:.0f},{:.0f},{:.3f}", name, test_name,
                          models[m].name, c.recovery_ms, c.indices_ms, c.vertices_ms,
                          c.recovery_ms / (c.recovery_ms + c.indices_ms),
                          c.recovery_ms / (c.recovery_ms + c.indices_ms + c.vertices_ms), c.indices, c.sent,
                          c.indices / triangles));
    }
  }
}

/// Table 4, and indices per triangle: at 41 resolutions.
void write_levels(const std::string& name, const std::filesystem::path& folder,
                  const std::vector<Model>& models, std::uint32_t finest, std::uint32_t coarsest,
                  const TotalOrder& order, Drawing& drawing) {
  CsvFile csv(folder / "strips_levels.csv", "mesh,resolution_share,triangles,model,indices,draw_ms");
  for (int i = 0; i <= 40; ++i) {
    const double share = i / 40.0;
    const auto r = coarsest + static_cast<std::uint32_t>(std::lround((finest - coarsest) * share));
    const std::uint32_t triangles = triangles_at(order, r);
    for (const Model& model : models) {
      model.set_resolution(r);
      std::vector<double> times;
      std::size_t count = 0;
      for (int k = 0; k < 15; ++k) {
        const double start = thread_ms();
        count = drawing.list_indices(model);
        drawing.list_vertices(count);
        times.push_back(thread_ms() - start);
      }
      csv.row(
          fmt::format("{},{:.3f},{},{},{},{:.5f}", name, share, triangles, model.name, count, median(times)));
    }
  }
}

Result<TotalOrder> order_of(const char* path) {
  auto mesh = load_mesh(path, std::uint64_t{4} << 30);
  if (!mesh) return fail(mesh.error());
  return bench::order_by_quadrics(*mesh);
}

Result<void> run(const std::string& name, const char* path, const std::filesystem::path& folder) {
  const auto order = order_of(path);
  if (!order) return fail(order.error());
  const auto n = static_cast<std::uint32_t>(order->positions.size());
  baselines::ProgressiveMesh pm(order->triangles, order->substitute, order->base);
  baselines::Mts mts(order->triangles, order->substitute, order->base, mts_longest);
  StripMesh fixed = build_strips(order->triangles, order->substitute, order->base, {one_band, false});
  StripMesh strips = build_strips(order->triangles, order->substitute, order->base);
  const std::uint32_t coarsest = std::max(order->base, pm.base_resolution());
  const std::vector<Model> models{model_of("PM", pm, pm.base_resolution()), model_of("MTS", mts, order->base),
                                  model_of("the paper's strips", fixed, order->base),
                                  model_of("strips", strips, order->base)};
  CsvFile csv(folder / "strips_memory.csv", "mesh,vertices,triangles,coarsest,model,bytes,bytes_per_vertex");
  for (const Model& m : models) {
    const std::uint64_t bytes = m.bytes + std::uint64_t{n} * sizeof(Vec3f);
    csv.row(fmt::format("{},{},{},{},{},{},{:.1f}", name, n, order->triangles.size(), m.base, m.name, bytes,
                        static_cast<double>(bytes) / n));
  }
  Drawing drawing(*order);
  write_tests(name, folder, models, n, coarsest, drawing);
  write_levels(name, folder, models, n, coarsest, *order, drawing);
  return {};
}

Result<void> draw(const std::filesystem::path& folder) {
  std::ifstream in(folder / "strips_levels.csv");
  if (!in)
    return fail(ErrorCode::not_found, (folder / "strips_levels.csv").string(), "", "run the bench first");
  std::map<std::string, std::map<std::string, plot::Series>> per_triangle, time;
  std::vector<std::string> meshes;
  for (const bench::Row& row : bench::rows_of(in)) {
    const std::string &mesh = row.at("mesh"), &model = row.at("model");
    if (std::find(meshes.begin(), meshes.end(), mesh) == meshes.end()) meshes.push_back(mesh);
    const double share = std::stod(row.at("resolution_share")), triangles = std::stod(row.at("triangles"));
    auto& a = per_triangle[mesh][model];
    a.x.push_back(share * 100);
    a.y.push_back(std::stod(row.at("indices")) / triangles);
    auto& b = time[mesh][model];
    b.x.push_back(share * 100);
    b.y.push_back(std::stod(row.at("draw_ms")));
  }
  plot::Chart chart;
  chart.title = "Strips against a progressive mesh and multiresolution triangle strips";
  chart.x = {.label = "resolution (% of the vertices)", .logarithmic = false, .low = 0.0, .high = 100.0};
  const auto add = [&](const std::string& title, const char* label,
                       std::map<std::string, plot::Series>& lines) {
    plot::Panel panel{title, {label, false, 0.0, {}}, {}, {}};
    for (const char* model : {"PM", "MTS", "the paper's strips", "strips"}) {
      lines[model].name = model;
      panel.series.push_back(lines[model]);
    }
    chart.panels.push_back(std::move(panel));
  };
  for (const std::string& mesh : meshes) add(mesh + ": indices per triangle", "indices", per_triangle[mesh]);
  for (const std::string& mesh : meshes) add(mesh + ": drawing", "time (ms)", time[mesh]);
  return write_svg(folder / "strips.svg", chart);
}

/// The order of the paper: only along the sides of the strips of the full mesh.
TotalOrder order_along_strips(const SurfaceMesh& mesh) {
  StripSides sides(stripify(mesh.triangles, static_cast<std::uint32_t>(mesh.positions.size())));
  return bench::order_by_quadrics(
      mesh, {[&](auto u, auto v) { return sides.allows(u, v); },
             [&](auto u, auto v, auto around, auto shared) { sides.applied(u, v, around, shared); }});
}

/// Mean distance between the mesh and what is drawn at so many vertices, both ways, % of the diagonal.
double mean_error(const SurfaceMesh& mesh, const TotalOrder& order, std::uint32_t r) {
  SurfaceMesh drawn{order.positions, {}, {}, {}, {}};
  for (Triangle t : order.triangles) {
    for (std::uint32_t& v : t)
      while (v >= r) v = order.substitute[v];
    if (!is_degenerate(t)) drawn.triangles.push_back(t);
  }
  const measure::SamplingOptions sampling{200'000, 1};
  const double there = measure::surface_distance(mesh, measure::make_tree(drawn), sampling).mean;
  const double back = measure::surface_distance(drawn, measure::make_tree(mesh), sampling).mean;
  Box3<double> box;
  for (const Vec3d& p : mesh.positions) box.add(p);
  return (there + back) / 2 / length(box.hi - box.lo) * 100;
}

/// Indices per triangle, the mean of the linear test's, and bytes.
void print_design(const char* what, const TotalOrder& order, const StripOptions& options) {
  const double start = thread_ms();
  StripMesh mesh = build_strips(order.triangles, order.substitute, order.base, options);
  const double built = thread_ms() - start;
  const auto n = static_cast<std::uint32_t>(order.positions.size());
  Drawing drawing(order);
  const Model model = model_of("", mesh, order.base);
  double indices = 0, triangles = 0;
  for (int i = 0; i < 20; ++i) {
    const auto r = n - static_cast<std::uint32_t>((n - order.base) * (i / 20.0));
    mesh.set_resolution(r);
    indices += static_cast<double>(drawing.list_indices(model));
    triangles += triangles_at(order, r);
  }
  const Cost cost = compare({model}, linear_test(n, order.base), drawing)[0];
  fmt::print(
      "{}, band ratio {}, {} length: {:.3f} indices per triangle, {:.1f} bytes per vertex, recovery {:.4f} "
      "ms, "
      "indices {:.4f} ms, built in {:.0f} ms\n",
      what, options.band_ratio, options.dynamic_length ? "dynamic" : "fixed", indices / triangles,
      static_cast<double>(mesh.bytes()) / n, cost.recovery_ms, cost.indices_ms, built);
}

Result<void> design(const char* path) {
  const auto mesh = load_mesh(path, std::uint64_t{4} << 30);
  if (!mesh) return fail(mesh.error());
  const TotalOrder order = bench::order_by_quadrics(*mesh);
  const TotalOrder along = order_along_strips(*mesh);
  for (const std::uint32_t part : {2u, 5u, 10u}) {
    const auto r = static_cast<std::uint32_t>(mesh->positions.size()) / part;
    if (r >= along.base)
      fmt::print("mean error at 1/{}: {:.4f} % free, {:.4f} % along strips\n", part,
                 mean_error(*mesh, order, r), mean_error(*mesh, along, r));
  }
  fmt::print("along strips down to {} vertices of {}\n", along.base, along.positions.size());
  for (const double ratio : {one_band, 2.0})
    for (const bool dynamic : {false, true}) print_design("along strips", along, {ratio, dynamic});
  for (const double ratio : {one_band, 4.0, 2.0, std::sqrt(2.0), std::pow(2.0, 0.25)})
    for (const bool dynamic : {false, true}) print_design("strips", order, {ratio, dynamic});
  const auto tom = build_tom(*mesh);
  if (!tom) return fail(tom.error());
  TotalOrder of_tom{{}, tom->triangles, tom->substitute, tom->base_vertices};
  for (const Vec3f& p : tom->positions) of_tom.positions.push_back(vec_cast<double>(p) + tom->origin);
  print_design("strips of the TOM", of_tom, {});
  const auto n = static_cast<std::uint32_t>(order.positions.size());
  Drawing drawing(order);
  for (const std::uint32_t longest : {8u, 16u, 32u, 64u, 1u << 30}) {
    baselines::Mts mts(order.triangles, order.substitute, order.base, longest);
    const Cost cost = compare({model_of("", mts, order.base)}, linear_test(n, order.base), drawing)[0];
    fmt::print(
        "MTS, at most {} entries: {:.0f} indices, recovery {:.4f} ms, indices {:.4f} ms, vertices {:.4f} "
        "ms\n",
        longest, cost.indices, cost.recovery_ms, cost.indices_ms, cost.vertices_ms);
  }
  return {};
}

}  // namespace

int main(int argc, char** argv) {
  const auto is = [&](const char* word, int count) {
    return argc == count && std::strcmp(argv[1], word) == 0;
  };
  const Result<void> done =
      is("run", 5)      ? run(argv[2], argv[3], argv[4])
      : is("design", 3) ? design(argv[2])
      : is("plot", 3)   ? draw(argv[2])
                        : fail(ErrorCode::invalid_input, "", "",
                               "usage: cuesta-bench-strips run NAME MESH FOLDER | design MESH | plot FOLDER");
  if (done) return 0;
  fmt::print(stderr, "cuesta-bench-strips: {}\n", done.error().text());
  return exit_status(done.error().code);
}
