// cuesta-bench-tom errors|rate|bytes|traversal NAME MESH [CSV]: the tables and figures of the TOM's paper,
// one row each. cuesta-bench-tom cut MESH TRIANGLES OUT.ply writes a resolution; plot FOLDER draws.
#include <fmt/format.h>

#include <tbb/task_arena.h>
#include <algorithm>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <fstream>
#include <memory>
#include <string>

#include "apps/measure/surface_distance.h"
#include "apps/plot/svg_plot.h"
#include "hierarchy/build_tom.h"
#include "hierarchy/tom_codec.h"
#include "hierarchy/tom_cursor.h"
#include "ooc/mesh_reader.h"
#include "ooc/mesh_writer.h"
#include "tools/bench/csv_rows.h"

namespace {

using namespace cuesta;

[[noreturn]] void give_up(const std::string& message) {
  fmt::print(stderr, "cuesta-bench-tom: {}\n", message);
  std::exit(1);
}

/// Geometry alone, as in the paper.
SurfaceMesh geometry_of(const char* path) {
  auto mesh = load_mesh(path, std::uint64_t{8} << 30);
  if (!mesh) give_up(mesh.error().text());
  mesh->normals.clear();
  mesh->colours.clear();
  mesh->texcoords.clear();
  return std::move(*mesh);
}

Tom tom_of(const SurfaceMesh& mesh, const TomOptions& options = {}) {
  auto tom = build_tom(mesh, options);
  if (!tom) give_up(tom.error().text());
  return std::move(*tom);
}

double processor_s() {
  return static_cast<double>(std::clock()) / CLOCKS_PER_SEC;
}

double wall_s() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

double median(std::vector<double> v) {
  std::sort(v.begin(), v.end());
  return v[v.size() / 2];
}

/// Rows go to the screen and, appended, to a file.
class Table {
 public:
  Table(const char* path, const std::string& columns) {
    if (!path) return;
    const bool is_new = !std::ifstream(path).good();
    file_.open(path, std::ios::app);
    if (is_new) file_ << columns << '\n';
  }
  void row(const std::string& line) {
    fmt::print("{}\n", line);
    if (file_.is_open()) file_ << line << '\n';
  }

 private:
  std::ofstream file_;
};

// ---- table 2

/// The paper's rows, for a bunny of 69,449 triangles: triangles, and what is not to be exceeded, in % of the
/// diagonal. Means at 50 and 25 % are those of a half-edge simplifier that does better than the paper there.
struct PaperRow {
  std::uint32_t triangles;
  double mean, max;
};
constexpr PaperRow paper_errors[] = {{34653, 0.0045, 0.474}, {16006, 0.0134, 0.840}, {6873, 0.0258, 0.799},
                                     {3428, 0.0439, 1.05},   {1361, 0.0954, 1.03},   {675, 0.186, 1.79},
                                     {337, 0.345, 2.41}};

void errors(const std::string& name, const char* path, const char* csv) {
  const SurfaceMesh mesh = geometry_of(path);
  const double diagonal = measure::bounding_diagonal(mesh);
  Table table(
      csv,
      "mesh,fairness,vertices,triangles,mean_percent,most_mean_percent,max_percent,max_from_original_percent,"
      "most_max_percent,bound_percent");
  for (const auto& [fairness, words] :
       {std::pair{TomFairness::memoryless, "memoryless"}, std::pair{TomFairness::quadric, "quadric"}}) {
    const Tom tom = tom_of(mesh, {.fairness = fairness});
    for (const PaperRow& paper : paper_errors) {
      const Resolution n = resolution_of_triangles(tom, paper.triangles);
      const SurfaceMesh cut = surface_at(tom, n);
      const auto d = measure::percent_of(measure::symmetric_distance(mesh, cut), diagonal);
      table.row(fmt::format("{},{},{},{},{:.5f},{},{:.4f},{:.4f},{},{:.4f}", name, words, n,
                            cut.triangles.size(), d.mean, paper.mean, d.max, d.forward.max, paper.max,
                            100 * (error_at(tom, n) + tom.snap_error) / diagonal));
    }
  }
}

// ---- table 3

/// Of one thread its processor time, of two the time that passes: in turns.
void rate(const std::string& name, const char* path, const char* csv) {
  const SurfaceMesh mesh = geometry_of(path);
  Table table(csv,
              "mesh,fairness,triangles,processor_s,least_processor_s,triangles_per_s,most_triangles_per_s,"
              "two_threads_s,speed_up");
  for (const auto& [fairness, words] :
       {std::pair{TomFairness::memoryless, "memoryless"}, std::pair{TomFairness::quadric, "quadric"}}) {
    const TomOptions options{.fairness = fairness};
    std::vector<double> one, one_wall, two;
    for (int i = 0; i < 7; ++i) {
      for (const int threads : {1, 2}) {
        tbb::task_arena arena(threads);
        const double start = processor_s(), start_wall = wall_s();
        arena.execute([&] { tom_of(mesh, options); });
        (threads == 1 ? one_wall : two).push_back(wall_s() - start_wall);
        if (threads == 1) one.push_back(processor_s() - start);
      }
    }
    const auto triangles = static_cast<double>(mesh.triangles.size());
    const double least = *std::min_element(one.begin(), one.end());
    table.row(fmt::format("{},{},{},{:.4f},{:.4f},{:.0f},{:.0f},{:.4f},{:.2f}", name, words,
                          mesh.triangles.size(), median(one), least, triangles / median(one),
                          triangles / least, median(two), median(one_wall) / median(two)));
  }
}

// ---- table 4

/// 32-bit numbers, normals as the only attribute. PM: 56 bytes for each vertex split, and for what is drawn
/// 24 per vertex and 24 per triangle (three corners, three neighbours): with these the paper's figures come
/// out.
void bytes(const std::string& name, const char* path, const char* csv) {
  SurfaceMesh mesh = geometry_of(path);
  mesh.normals.assign(mesh.positions.size(), Vec3f{0, 0, 1});
  const Tom tom = tom_of(mesh);
  const auto face_vertex = [](std::uint64_t vertices, std::uint64_t triangles) {
    return 24 * vertices + 12 * triangles;
  };
  const std::uint64_t whole = face_vertex(tom.full(), tom.triangles.size());
  std::uint64_t levels = 0;
  for (const double share : {1.0, 0.5, 0.25, 0.12, 0.06, 0.03}) {
    const Resolution n = resolution_of_triangles(
        tom, static_cast<std::uint32_t>(share * static_cast<double>(tom.triangles.size())));
    levels += face_vertex(n, triangle_count(tom, n));
  }
  std::uint64_t stored = 0;
  Resolution from = 0;
  for (const Resolution to : segment_resolutions(tom)) {
    stored += encode_tom_segment(tom, from, to).size();
    from = to;
  }
  const std::uint64_t ours = size_bytes(tom), steps = 8 * tom.errors.size();
  const std::uint64_t splits = 56ull * tom.full();
  Table table(csv, "mesh,vertices,triangles,structure,bytes,percent_of_face_vertex");
  const auto row = [&](const char* structure, std::uint64_t size) {
    table.row(fmt::format("{},{},{},{},{},{:.2f}", name, tom.full(), tom.triangles.size(), structure, size,
                          100 * static_cast<double>(size) / static_cast<double>(whole)));
  };
  row("face-vertex", whole);
  row("TOM", ours - steps);
  row("TOM with its errors", ours);
  row("six levels", levels);
  row("PM at 0 %", splits);
  row("PM at 100 %", splits + 24ull * tom.full() + 24ull * tom.triangles.size());
  row("TOM in a file", stored);
}

// ---- figures 6 and 7

/// What both sides do with a triangle: read its three numbers.
struct Reader {
  std::uint32_t sum = 0;
  void operator()(const Triangle& t) { sum = ((sum + t[0]) ^ t[1]) + t[2]; }
};

volatile std::uint32_t sink;

template <class Work>
double best_ns(std::uint32_t triangles, const Work& work) {
  double best = 1e30;
  for (int i = 0; i < 15; ++i) {
    const auto start = std::chrono::steady_clock::now();
    work();
    best = std::min(
        best, std::chrono::duration<double, std::nano>(std::chrono::steady_clock::now() - start).count());
  }
  return best / triangles;
}

std::uint64_t chain_steps(const Tom& tom, Resolution n, std::uint32_t triangles) {
  std::uint64_t steps = 0;
  for (std::uint32_t t = 0; t < triangles; ++t)
    for (std::uint32_t c : tom.triangles[t])
      for (; c >= n; c = tom.substitute[c]) ++steps;
  return steps;
}

void traverse_at(Table& table, const std::string& name, const Tom& tom, double share) {
  const Resolution n = whole_resolution(tom, static_cast<Resolution>(share * tom.full()));
  std::vector<Triangle> plain(triangle_count(tom, n)), out(plain.size());
  const auto triangles = static_cast<std::uint32_t>(plain.size());
  if (triangles == 0) return;
  extract_triangles(tom, n, plain);
  TomCursor cursor(tom);
  const auto visit = [&](Resolution at) {
    Reader read;
    cursor.visit(at, [&read](const Triangle& t) { read(t); });
    sink = read.sum;
  };
  visit(n);
  const double corners = 3.0 * triangles;
  const double from_rung = cursor.followed() / corners;
  const double whole_chains = static_cast<double>(chain_steps(tom, n, triangles)) / corners;
  const double read = best_ns(triangles, [&] {
    Reader reader;
    for (const Triangle& t : plain) reader(t);
    sink = reader.sum;
  });
  const double still = best_ns(triangles, [&] { visit(n); });
  // Another resolution each time, as in a flight.
  const Resolution next = whole_resolution(tom, n - std::min(n - tom.base_vertices, 1 + n / 200));
  bool turn = false;
  const double moving = best_ns(triangles, [&] { visit((turn = !turn) ? next : n); });
  const double written = best_ns(triangles, [&] { cursor.extract(n, out); });
  const double chains = best_ns(triangles, [&] { extract_triangles(tom, n, out); });
  table.row(fmt::format("{},{},{},{},{:.3f},{:.3f},{:.3f},{:.3f},{:.3f},{:.3f},{:.3f},{:.2f},{:.2f}", name,
                        share, n, triangles, whole_chains, from_rung, read, still, moving, written, chains,
                        read / still, read / moving));
}

void traversal(const std::string& name, const char* path, const char* csv) {
  const Tom tom = tom_of(geometry_of(path));
  Table table(
      csv,
      "mesh,share,vertices,triangles,steps_per_corner_of_chains,steps_per_corner_of_cursor,plain_read_ns,"
      "cursor_ns,cursor_moving_ns,cursor_written_ns,chains_written_ns,cursor_rate_of_plain,moving_rate_of_"
      "plain");
  for (const double share :
       {1.0, 0.9, 0.8, 0.7, 0.6, 0.5, 0.4, 0.3, 0.2, 0.15, 0.1, 0.07, 0.05, 0.03, 0.02, 0.01})
    traverse_at(table, name, tom, share);
}

// ---- plots

std::vector<bench::Row> table_of(const std::string& path) {
  std::ifstream in(path);
  if (!in) give_up(path + ": not found; run tools/bench/tom first");
  return bench::rows_of(in);
}

plot::Series series_of(const std::vector<bench::Row>& rows, const char* key, const std::string& value,
                       const char* x, const char* y, const std::string& name, double scale_x = 1) {
  plot::Series s{name, {}, {}, {}};
  for (const bench::Row& row : rows) {
    if (row.at(key) != value) continue;
    s.x.push_back(scale_x * std::stod(row.at(x)));
    s.y.push_back(std::stod(row.at(y)));
  }
  return s;
}

void write(const std::string& path, const plot::Chart& chart) {
  if (const auto done = plot::write_svg(path, chart); !done) give_up(done.error().text());
}

void plot_errors(const std::string& folder) {
  const auto rows = table_of(folder + "/tom_errors.csv");
  plot::Chart chart;
  chart.title = "The bunny at its resolutions";
  chart.x = {.label = "triangles", .logarithmic = true, .low = {}, .high = {}};
  for (const auto& [title, ours, paper] : {std::array{"Mean error", "mean_percent", "most_mean_percent"},
                                           std::array{"Largest error", "max_percent", "most_max_percent"}}) {
    plot::Panel panel{title, {"% of the diagonal", true, {}, {}}, {}, {}};
    panel.series = {series_of(rows, "fairness", "memoryless", "triangles", ours, "memoryless"),
                    series_of(rows, "fairness", "quadric", "triangles", ours, "quadric"),
                    series_of(rows, "fairness", "memoryless", "triangles", paper, "not to be exceeded")};
    chart.panels.push_back(panel);
  }
  write(folder + "/tom_errors.svg", chart);
}

void plot_traversal(const std::string& folder) {
  const auto rows = table_of(folder + "/tom_traversal.csv");
  std::vector<std::string> names;
  for (const bench::Row& row : rows)
    if (std::find(names.begin(), names.end(), row.at("mesh")) == names.end()) names.push_back(row.at("mesh"));
  plot::Chart chart;
  chart.title = "Traversal of a TOM at its resolutions";
  chart.x = {.label = "vertices (% of all)", .logarithmic = false, .low = 0.0, .high = 100.0};
  plot::Panel followed{"Substitutions followed per corner", {"of a cursor", false, 0.0, {}}, {}, {}};
  plot::Panel chains{"The same along whole chains, without a cursor", {"of chains", false, 0.0, {}}, {}, {}};
  plot::Panel rates{"Rate against reading a plain index buffer", {"ratio", false, 0.0, {}}, {}, {}};
  followed.limits = {{"at most", 0.75}, {"aim", 0.25}};
  rates.limits = {{"at least", 0.5}};
  for (const std::string& name : names) {
    followed.series.push_back(
        series_of(rows, "mesh", name, "share", "steps_per_corner_of_cursor", name, 100));
    chains.series.push_back(series_of(rows, "mesh", name, "share", "steps_per_corner_of_chains", name, 100));
    rates.series.push_back(series_of(rows, "mesh", name, "share", "cursor_rate_of_plain", name, 100));
  }
  chart.panels = {followed, chains, rates};
  write(folder + "/tom_traversal.svg", chart);
}

// ---- pictures

void cut(const char* path, const char* triangles, const char* out) {
  const Tom tom = tom_of(geometry_of(path));
  const auto done = write_mesh(
      out, surface_at(tom, resolution_of_triangles(tom, static_cast<std::uint32_t>(std::stoul(triangles)))));
  if (!done) give_up(done.error().text());
}

}  // namespace

int main(int count, char** words) {
  const std::string what = count > 1 ? words[1] : "";
  const char* csv = count > 4 ? words[4] : nullptr;
  if (what == "plot" && count == 3) {
    plot_errors(words[2]);
    plot_traversal(words[2]);
  } else if (what == "cut" && count == 5) {
    cut(words[2], words[3], words[4]);
  } else if (what == "errors" && count > 3) {
    errors(words[2], words[3], csv);
  } else if (what == "rate" && count > 3) {
    rate(words[2], words[3], csv);
  } else if (what == "bytes" && count > 3) {
    bytes(words[2], words[3], csv);
  } else if (what == "traversal" && count > 3) {
    traversal(words[2], words[3], csv);
  } else {
    give_up("usage: errors|rate|bytes|traversal NAME MESH [CSV], cut MESH TRIANGLES OUT.ply, or plot FOLDER");
  }
}
