// cuesta-bench-fan compare NAME MESH FOLDER [up=x|y|z] [route] [slow=TAU]...: tables 1 to 3 of the
// fan-hierarchy's paper,
//   of one model: the fan-hierarchy against a view-dependence tree, on the same flights in one run. Appends
//   to FOLDER/fan_*.csv; with `route`, for a terrain in the plane x, y, also its figure 10, and every frame;
//   with `slow` also flights a tenth as fast with other tau.
// cuesta-bench-fan rates NAME MESH FOLDER [up=x|y|z]: what whole frames of both cost, the picture included,
// by the
//   software renderer. Appends to FOLDER/fan_rates.csv.
// cuesta-bench-fan scene OUT.ply MESH...: models side by side.
// cuesta-bench-fan plot FOLDER: FOLDER/fan.svg.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <ctime>
#include <functional>
#include <numeric>
#include <string>

#include "apps/measure/screen_error.h"
#include "runtime/extract.h"
#include "runtime/flight.h"
#include "runtime/view_fit.h"
#include "tools/baselines/vdt_cut.h"
#include "tools/bench/fan_frame_rate.h"
#include "tools/bench/fan_inputs.h"

namespace {

using namespace cuesta;
using baselines::VdtCut;
using baselines::VdtReport;
using baselines::ViewDependenceTree;

constexpr int flight_frames = 300;
constexpr int runs = 5;  // of which the median counts, frame by frame

/// Processor time of this thread: what a frame costs on one core, whatever else the machine does.
double thread_ms() {
  timespec t{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &t);
  return static_cast<double>(t.tv_sec) * 1e3 + static_cast<double>(t.tv_nsec) * 1e-6;
}

/// What both did in one frame.
struct Frame {
  AdaptReport fan;
  VdtReport vdt;
  double fan_ms = 0, fan_list_ms = 0, vdt_ms = 0;
};

struct Way {
  std::string name;
  double tau = 2;  // of the fan-hierarchy, pixels; 2: the paper's
  std::vector<View> views = {};
};

double median(std::vector<double> v) {
  std::nth_element(v.begin(), v.begin() + static_cast<std::ptrdiff_t>(v.size() / 2), v.end());
  return v[v.size() / 2];
}

class CsvFile {
 public:
  CsvFile(const std::filesystem::path& path, const char* head) {
    const bool fresh = !std::filesystem::exists(path);
    file_ = std::fopen(path.c_str(), "a");
    if (file_ && fresh) fmt::print(file_, "{}\n", head);
  }
  ~CsvFile() {
    if (file_) std::fclose(file_);
  }
  CsvFile(const CsvFile&) = delete;
  CsvFile& operator=(const CsvFile&) = delete;
  void row(const std::string& line, bool also_print = true) {
    if (file_) fmt::print(file_, "{}\n", line);
    if (also_print) fmt::print("{}\n", line), std::fflush(stdout);
  }

 private:
  std::FILE* file_;
};

class Comparison {
 public:
  /// @param keep_frames  write each frame, not only averages
  Comparison(std::string name, std::filesystem::path folder, bool keep_frames)
      : keep_frames_(keep_frames),
        name_(std::move(name)),
        folder_(std::move(folder)),
        path_(std::filesystem::temp_directory_path() / (name_ + ".fan-bench.cuesta")) {}
  ~Comparison() {
    std::error_code ignored;
    std::filesystem::remove(path_, ignored);
  }
  Comparison(const Comparison&) = delete;
  Comparison& operator=(const Comparison&) = delete;

  /// @param write_times  a row of fan_models.csv, for which the build is done twice
  Result<void> build(const std::filesystem::path& mesh, bool write_times = true) {
    auto one = bench::build_file(mesh, path_, 1);
    if (!one) return fail(one.error());
    auto two = write_times ? bench::build_file(mesh, path_, 2) : one;
    if (!two) return fail(two.error());
    if (auto opened = open(); !opened) return opened;
    auto built = bench::build_tree(*fan_);
    if (!built) return fail(built.error());
    tree_ = std::move(built->tree);
    vdt_ = std::make_unique<VdtCut>(tree_);
    if (!write_times) return {};
    const Directory& d = fan_->directory();
    CsvFile csv(
        folder_ / "fan_models.csv",
        "model,vertices,triangles,ingest_processor_s,fan_processor_s,fan_wall_s,fan_two_threads_processor_s,"
        "fan_two_threads_wall_s,vdt_processor_s,vdt_wall_s,fans,substitutions,vdt_internal_nodes,fan_bytes,"
        "vdt_tree_bytes,vdt_run_time_bytes_per_vertex,file_bytes,pages");
    csv.row(fmt::format("{},{},{},{:.3f},{:.3f},{:.3f},{:.3f},{:.3f},{:.3f},{:.3f},{},{},{},{},{},{},{},{}",
                        name_, d.vertices, d.triangles, one->ingest.processor, one->build.processor,
                        one->build.wall, two->build.processor, two->build.wall, built->build.processor,
                        built->build.wall, one->report.fans, one->report.substitutions,
                        tree_.internal_nodes(), fan_bytes(), tree_.bytes(), 8,
                        std::filesystem::file_size(path_), d.pages.size()));
    return {};
  }

  /// Writes what both do on the way: with the same tau, with as many triangles, and with as large an error on
  /// the screen.
  Result<void> fly(const Way& way, bool is_route = false) {
    if (auto opened = open(); !opened) return opened;
    const auto nominal = run(way, way.tau);
    write(way, "same tau", way.tau, nominal);
    const double triangles_tau =
        tau_of_equal_triangles(way, average_of(nominal, [](const Frame& f) { return f.fan.triangles; }));
    const auto equal = run(way, triangles_tau);
    write(way, "equal triangles", triangles_tau, equal);
    if (keep_frames_) write_frames(way, is_route, nominal, equal);
    if (is_route) return {};
    const double error_tau = tau_of_equal_error(way);
    write(way, "equal error", error_tau, run(way, error_tau));
    return {};
  }

  /// Writes what frames of both cost with the same measured error, every tenth of them drawn.
  Result<void> draw(const Way& way) {
    if (auto opened = open(); !opened) return opened;
    const double vdt_tau = tau_of_equal_error(way);
    auto rate = bench::FrameRate::create(fan_->directory().grid, tree_);
    if (!rate) return fail(rate.error());
    settle_fan(way, way.views.front());
    settle_tree(way.views.front(), vdt_tau);
    std::vector<double> fan_ms, vdt_ms, fan_adapt_ms, vdt_adapt_ms;
    double fan_triangles = 0, vdt_triangles = 0;
    for (std::size_t i = 0; i < way.views.size(); ++i) {
      const ErrorScale s = scale(way.views[i]);
      const double start = thread_ms();
      fan_triangles += static_cast<double>(fan_->adapt(s, way.tau, {}).triangles);
      const DrawList list = fan_->draw_list();
      const double listed = thread_ms();
      vdt_triangles += static_cast<double>(vdt_->adapt(s, vdt_tau).triangles);
      const double adapted = thread_ms();
      auto fan_drawn = rate->draw_fan(list, way.views[i]);
      if (!fan_drawn) return fail(fan_drawn.error());
      if (i % 10 != 5) continue;
      auto vdt_drawn = rate->draw_tree(vdt_->drawing_list(), way.views[i]);
      if (!vdt_drawn) return fail(vdt_drawn.error());
      fan_adapt_ms.push_back(listed - start), fan_ms.push_back(fan_adapt_ms.back() + *fan_drawn);
      vdt_adapt_ms.push_back(adapted - listed), vdt_ms.push_back(vdt_adapt_ms.back() + *vdt_drawn);
    }
    const auto frames = static_cast<double>(way.views.size());
    CsvFile csv(folder_ / "fan_rates.csv",
                "model,flight,tau_px,vdt_tau_px,fan_triangles,vdt_triangles,fan_adapt_ms,vdt_adapt_ms,"
                "fan_frame_ms,vdt_frame_ms,ratio");
    csv.row(fmt::format("{},{},{},{:.4f},{:.0f},{:.0f},{:.3f},{:.3f},{:.2f},{:.2f},{:.2f}", name_, way.name,
                        way.tau, vdt_tau, fan_triangles / frames, vdt_triangles / frames,
                        median(fan_adapt_ms), median(vdt_adapt_ms), median(fan_ms), median(vdt_ms),
                        median(vdt_ms) / median(fan_ms)));
    return {};
  }

  /// Figure 10: from the lower left corner to the middle, in so many frames.
  Result<void> fly_route(const View& size, int frames, const char* speed) {
    const Grid& grid = fan_->directory().grid;
    const Vec3d lo = grid.world(fan_->directory().lo), hi = grid.world(fan_->directory().hi);
    const double above = hi.z + 0.05 * (hi.x - lo.x);
    const Vec3d from{lo.x, lo.y, above}, to{(lo.x + hi.x) / 2, (lo.y + hi.y) / 2, above};
    Way way{fmt::format("route in {} frames: {}", frames, speed)};
    for (int i = 0; i <= frames; ++i) {
      View view = size;
      view.eye = from + (to - from) * (static_cast<double>(i) / frames);
      view.target = view.eye + (to - from) * 0.5 - Vec3d{0, 0, above - lo.z};
      way.views.push_back(view);
    }
    return fly(way, true);
  }

  /// @param slower  so many times, over the middle of the way
  Way flight(FlightKind kind, std::string flight_name, const View& size, double tau = 2,
             int slower = 1) const {
    Way way{std::move(flight_name), tau};
    const std::vector<Vec3d> points = original(100);
    const std::uint64_t frames = std::uint64_t{flight_frames} * static_cast<std::uint64_t>(slower);
    const Flight flight = make_flight(kind, {points, points.front()}, size, frames);
    const std::uint64_t first = (frames - flight_frames) / 2;
    for (std::uint64_t i = first; i < first + flight_frames; ++i)
      way.views.push_back(flight_view(flight, frame_time(flight, i), size));
    return way;
  }

 private:
  /// A cut with no more than the base page: others come with the first run of a flight.
  Result<void> open() {
    auto file = CuestaFile::open(path_);
    if (!file) return fail(file.error());
    auto cut = Cut::open(std::move(*file), std::uint64_t{16} << 30, thread_ms);
    if (!cut) return fail(cut.error());
    fan_ = std::move(*cut);
    return {};
  }

  Vec3d world(std::uint32_t v) const {
    const Grid& grid = fan_->directory().grid;
    return grid.origin + vec_cast<double>(tree_.positions[v]) * grid.step;
  }
  ErrorScale scale(const View& view) const { return ErrorScale::perspective(fan_->directory().grid, view); }

  /// What is resident of all pages and the directory; without vertices (20 bytes) and triangles (20 bytes:
  /// indices, place, who is at its place), which a view-dependence tree needs as well.
  std::uint64_t fan_bytes() const {
    std::uint64_t bytes = 0;
    for (const PageId id : fan_->cache().resident_ids()) bytes += fan_->cache().resident(id)->bytes();
    for (const PageEntry& e : fan_->directory().pages)
      bytes += sizeof(PageEntry) + e.coarser.size() * sizeof(PageId);
    return bytes;
  }

  static double average_of(const std::vector<Frame>& frames,
                           const std::function<double(const Frame&)>& value) {
    double sum = 0;
    for (const Frame& f : frames) sum += value(f);
    return sum / static_cast<double>(frames.size());
  }

  void settle_fan(const Way& way, const View& view) {
    fan_->settle(scale(view), way.tau, {});
    fan_->draw_list();
  }
  void settle_tree(const View& view, double vdt_tau) {
    for (int i = 0; i < 100; ++i)
      if (const VdtReport r = vdt_->adapt(scale(view), vdt_tau); r.splits + r.collapses == 0) return;
  }

  std::vector<Frame> run_once(const Way& way, double vdt_tau) {
    settle_fan(way, way.views.front());
    settle_tree(way.views.front(), vdt_tau);
    std::vector<Frame> frames;
    for (std::size_t i = 1; i < way.views.size(); ++i) {
      const ErrorScale s = scale(way.views[i]);
      Frame f;
      const double start = thread_ms();
      f.fan = fan_->adapt(s, way.tau, {});
      const double adapted = thread_ms();
      fan_->draw_list();
      const double listed = thread_ms();
      f.vdt = vdt_->adapt(s, vdt_tau);
      f.vdt_ms = thread_ms() - listed;
      f.fan_ms = adapted - start;
      f.fan_list_ms = listed - adapted;
      frames.push_back(f);
    }
    return frames;
  }

  /// Both in turn, frame by frame; times are medians, counts those of the last run.
  std::vector<Frame> run(const Way& way, double vdt_tau) {
    std::vector<std::vector<Frame>> all;
    for (int r = 0; r < runs; ++r) all.push_back(run_once(way, vdt_tau));
    for (std::size_t i = 0; i < all[0].size(); ++i)
      for (double Frame::*ms : {&Frame::fan_ms, &Frame::fan_list_ms, &Frame::vdt_ms}) {
        std::vector<double> times;
        for (const auto& frames : all) times.push_back(frames[i].*ms);
        all.back()[i].*ms = median(std::move(times));
      }
    return all.back();
  }

  /// The largest tau (to 1 %) with which `too_fine` holds no longer.
  template <class F>
  static double bisect(double low, double high, const F& too_fine) {
    while (high / low > 1.01) {
      const double middle = std::sqrt(low * high);
      (too_fine(middle) ? low : high) = middle;
    }
    return std::sqrt(low * high);
  }

  /// The tree's tau with which it has as many triangles on the whole way.
  double tau_of_equal_triangles(const Way& way, double wanted) {
    return bisect(way.tau / 16, way.tau * 16, [&](double vdt_tau) {
      settle_tree(way.views.front(), vdt_tau);
      double sum = 0;
      for (std::size_t i = 1; i < way.views.size(); ++i)
        sum += static_cast<double>(vdt_->adapt(scale(way.views[i]), vdt_tau).triangles);
      return sum / static_cast<double>(way.views.size() - 1) > wanted;
    });
  }

  /// The tree's tau with which it has as large a measured error.
  double tau_of_equal_error(const Way& way) {
    const double wanted = measured_fan(way);
    return bisect(way.tau / 16, way.tau * 2,
                  [&](double vdt_tau) { return measured_tree(way, vdt_tau) < wanted; });
  }

  /// Three views of the way.
  static std::vector<View> measured_views(const Way& way) {
    const std::size_t n = way.views.size();
    return {way.views[n / 4], way.views[n / 2], way.views[n * 3 / 4]};
  }
  std::vector<Vec3d> original(std::uint32_t stride = 1) const {
    std::vector<Vec3d> points;
    for (std::uint32_t v = 0; v < tree_.leaves; v += stride) points.push_back(world(v));
    return points;
  }
  /// Every so many-th vertex: 100,000 and more of them.
  std::vector<Vec3d> judged() const { return original(std::max(1u, tree_.leaves / 100'000)); }
  /// 99.9 percentile of the measured screen error at original vertices in the picture, mean of three views at
  /// rest.
  double measured_fan(const Way& way) {
    double sum = 0;
    for (const View& view : measured_views(way)) {
      settle_fan(way, view);
      const auto mesh = extract_mesh(fan_->draw_list(), {false, false}).value();
      sum += measure::screen_error(judged(), measure::TriangleTree(mesh.positions, mesh.triangles), view)
                 .px.p999;
    }
    return sum / 3;
  }
  double measured_tree(const Way& way, double vdt_tau) {
    const auto points = original(), judges = judged();
    double sum = 0;
    for (const View& view : measured_views(way)) {
      settle_tree(view, vdt_tau);
      sum += measure::screen_error(judges, measure::TriangleTree(points, vdt_->drawing_list()), view).px.p999;
    }
    return sum / 3;
  }

  double triangles_at_rest(const Way& way) {
    double sum = 0;
    for (std::size_t i = 0; i < 10; ++i)
      sum += static_cast<double>(
          fan_->settle(scale(way.views[i * (way.views.size() - 1) / 9]), way.tau, {}).triangles);
    fan_->draw_list();
    return sum / 10;
  }

  void write_frames(const Way& way, bool is_route, const std::vector<Frame>& nominal,
                    const std::vector<Frame>& equal) {
    CsvFile csv(
        folder_ / (is_route ? "fan_route.csv" : "fan_frames.csv"),
        "model,flight,frame,fan_operations,edge_operations,fan_ms,fan_triangles,vdt_operations,vdt_ms,"
        "vdt_triangles,vdt_equal_operations,vdt_equal_ms,vdt_equal_triangles");
    for (std::size_t i = 0; i < nominal.size(); ++i) {
      const Frame &n = nominal[i], &e = equal[i];
      csv.row(fmt::format("{},{},{},{},{},{:.4f},{},{},{:.4f},{},{},{:.4f},{}", name_, way.name, i + 1,
                          n.fan.coarse_operations, n.fan.fine_operations, n.fan_ms, n.fan.triangles,
                          n.vdt.splits + n.vdt.collapses, n.vdt_ms, n.vdt.triangles,
                          e.vdt.splits + e.vdt.collapses, e.vdt_ms, e.vdt.triangles),
              false);
    }
  }

  void write(const Way& way, const char* kind, double vdt_tau, const std::vector<Frame>& frames) {
    const auto average = [&](auto value) {
      return average_of(frames, [&](const Frame& f) { return static_cast<double>(value(f)); });
    };
    CsvFile csv(
        folder_ / "fan_flights.csv",
        "model,flight,frames,compared_at,tau_px,vdt_tau_px,fan_operations,edge_operations,vdt_operations,"
        "vdt_forced_splits,vdt_put_off,fan_ms,fan_draw_list_ms,vdt_ms,fan_triangles,vdt_triangles,"
        "vdt_active_nodes,fan_triangles_at_rest,fan_p999_px,vdt_p999_px,fan_pages_loaded");
    csv.row(
        fmt::format("{},{},{},{},{},{:.4f},{:.1f},{:.1f},{:.1f},{:.1f},{:.1f},{:.4f},{:.4f},{:.4f},{:.0f},{:."
                    "0f},{:.0f},{:.0f},{:.3f},{:.3f},{}",
                    name_, way.name, frames.size(), kind, way.tau, vdt_tau,
                    average([](const Frame& f) { return f.fan.coarse_operations; }),
                    average([](const Frame& f) { return f.fan.fine_operations; }),
                    average([](const Frame& f) { return f.vdt.splits + f.vdt.collapses; }),
                    average([](const Frame& f) { return f.vdt.forced_splits; }),
                    average([](const Frame& f) { return f.vdt.put_off; }),
                    average([](const Frame& f) { return f.fan_ms; }),
                    average([](const Frame& f) { return f.fan_list_ms; }),
                    average([](const Frame& f) { return f.vdt_ms; }),
                    average([](const Frame& f) { return f.fan.triangles; }),
                    average([](const Frame& f) { return f.vdt.triangles; }),
                    average([](const Frame& f) { return f.vdt.active_nodes; }), triangles_at_rest(way),
                    measured_fan(way), measured_tree(way, vdt_tau),
                    std::accumulate(frames.begin(), frames.end(), 0u,
                                    [](unsigned n, const Frame& f) { return n + f.fan.pages_loaded; })));
  }

  bool keep_frames_;
  std::string name_;
  std::filesystem::path folder_, path_;
  std::unique_ptr<Cut> fan_;
  ViewDependenceTree tree_;
  std::unique_ptr<VdtCut> vdt_;
};

Vec3d up_of(const char* word) {
  return {double(word[3] == 'x'), double(word[3] == 'y'), double(word[3] == 'z')};
}

Result<void> compare(int argc, char** argv) {
  View size;  // 1280 × 720, 60°
  bool route = false;
  std::vector<double> slow;
  for (int i = 5; i < argc; ++i) {
    route = route || std::strcmp(argv[i], "route") == 0;
    if (std::strncmp(argv[i], "slow=", 5) == 0) slow.push_back(std::atof(argv[i] + 5));
    if (std::strncmp(argv[i], "up=", 3) == 0) size.up = up_of(argv[i]);
  }
  Comparison comparison(argv[2], argv[4], route);
  if (auto built = comparison.build(argv[3]); !built) return built;
  std::vector<Way> ways{comparison.flight(FlightKind::fly_over, "fly-over", size)};
  if (!route) ways.push_back(comparison.flight(FlightKind::orbit, "orbit", size));
  ways.push_back(comparison.flight(FlightKind::fly_over, "fly-over; 0.5 px", size, 0.5));
  for (const double tau : slow) {
    const auto flight_name = fmt::format("fly-over a tenth as fast; {} px", tau);
    ways.push_back(comparison.flight(FlightKind::fly_over, flight_name, size, tau, 10));
  }
  for (const Way& way : ways)
    if (auto flown = comparison.fly(way); !flown) return flown;
  if (!route) return {};
  for (const auto& [speed, frames] : {std::pair{"slower", 1000}, {"slow", 100}, {"medium", 50}, {"fast", 10}})
    if (auto flown = comparison.fly_route(size, frames, speed); !flown) return flown;
  return {};
}

Result<void> rates(int argc, char** argv) {
  View size;
  for (int i = 5; i < argc; ++i)
    if (std::strncmp(argv[i], "up=", 3) == 0) size.up = up_of(argv[i]);
  Comparison comparison(argv[2], argv[4], false);
  if (auto built = comparison.build(argv[3], false); !built) return built;
  for (const auto& [kind, flight_name] :
       {std::pair{FlightKind::fly_over, "fly-over"}, {FlightKind::orbit, "orbit"}})
    for (const double tau : {2.0, 0.5})
      if (auto drawn =
              comparison.draw(comparison.flight(kind, fmt::format("{}; {} px", flight_name, tau), size, tau));
          !drawn)
        return drawn;
  return {};
}

Result<void> scene(int argc, char** argv) {
  const std::vector<std::filesystem::path> meshes(argv + 3, argv + argc);
  return bench::write_scene(argv[2], meshes);
}

}  // namespace

int main(int argc, char** argv) {
  const auto is = [&](const char* word, int least) {
    return argc >= least && std::strcmp(argv[1], word) == 0;
  };
  Result<void> done =
      is("compare", 5) ? compare(argc, argv)
      : is("rates", 5) ? rates(argc, argv)
      : is("scene", 4) ? scene(argc, argv)
      : is("plot", 3)
          ? bench::draw_results(argv[2])
          : fail(ErrorCode::invalid_input, "", "",
                 "usage: cuesta-bench-fan compare NAME MESH FOLDER [up=z] [route] [slow=TAU]... | "
                 "rates NAME MESH FOLDER [up=z] | scene OUT.ply MESH... | plot FOLDER");
  if (done) return 0;
  fmt::print(stderr, "cuesta-bench-fan: {}\n", done.error().text());
  return exit_status(done.error().code);
}
