// cuesta-bench-route FILE.cuesta FLIGHT.json [NAME [TAU_PX]]: one route at three speeds, with the budgets of
//   cuesta-bench-frames: 4 ms of adapt(), a million triangles, 256 MiB. Writes NAME.csv, a row for each
//   speed, and NAME.svg, the statistics along the route. Exit status 1 if a frame has more triangles or
//   bytes.
#include <cstdlib>
#include <limits>
#include <thread>

#include "apps/plot/svg_plot.h"
#include "runtime/flight_file.h"
#include "tools/bench/frame_figures.h"

namespace {

using namespace cuesta;
using namespace cuesta::bench;

constexpr std::uint64_t most_triangles = 1'000'000, most_bytes = std::uint64_t{256} << 20;
constexpr double adapt_ms = 4;

struct Speed {
  const char* name;
  double factor;  ///< of the flight file's
};
constexpr Speed speeds[] = {{"as written", 1}, {"5 times", 5}, {"20 times", 20}};

template <class T>
T must(Result<T> result) {
  if (result) return std::move(*result);
  fmt::print(stderr, "cuesta-bench-route: {}\n", result.error().text());
  std::exit(1);
}

View full_hd() {
  View view;
  view.width_px = 1920;
  view.height_px = 1080;
  return view;
}

/// Each speed begins with the cut of a fresh start at the route's first view.
Part fly(const char* path, const Flight& flight, const Speed& speed, double tau) {
  const auto cut = must(Cut::open(must(CuestaFile::open(path)), most_bytes, clock_ms, 1));
  const Grid& grid = cut->directory().grid;
  Budgets budgets;
  budgets.triangles = most_triangles;
  const auto scale = [&](double t_s) {
    return ErrorScale::perspective(grid, flight_view(flight, t_s, full_hd()), 4);
  };
  cut->settle(scale(0), tau, budgets);
  budgets.adapt_ms = adapt_ms;
  budgets.upload_bytes = std::uint64_t{4} << 20;
  Part part{speed.name};
  const auto frames = static_cast<std::uint64_t>(static_cast<double>(frame_count(flight)) / speed.factor);
  for (std::uint64_t i = 0; i < frames; ++i) {
    const double before = thread_ms();
    part.frames.push_back(
        cut->adapt(scale(static_cast<double>(i) * speed.factor / flight.fps), tau, budgets));
    part.processor_ms.push_back(thread_ms() - before);
    cut->draw_list();
    // What drawing would take: the loader has the other core meanwhile.
    std::this_thread::sleep_for(std::chrono::milliseconds(16));
  }
  return part;
}

plot::Chart chart_of(const std::vector<Part>& parts) {
  plot::Chart chart;
  chart.title = "One route at three speeds";
  chart.x.label = "way (%)";
  const auto panel = [&](const char* title, const char* unit, std::vector<plot::Limit> limits, auto value) {
    plot::Panel p;
    p.title = title;
    p.y.label = unit;
    p.limits = std::move(limits);
    for (const Part& part : parts) {
      plot::Series s{part.name, {}, {}, {}};
      for (std::size_t i = 0; i < part.frames.size(); ++i) {
        s.x.push_back(100.0 * static_cast<double>(i) / static_cast<double>(part.frames.size()));
        s.y.push_back(value(part, i));
      }
      p.series.push_back(std::move(s));
    }
    chart.panels.push_back(std::move(p));
  };
  panel("adapt, processor time", "ms", {{"budget", adapt_ms}},
        [](const Part& p, std::size_t i) { return p.processor_ms[i]; });
  panel("triangles", "thousands", {{"budget", most_triangles / 1e3}},
        [](const Part& p, std::size_t i) { return static_cast<double>(p.frames[i].triangles) / 1e3; });
  panel("resident", "MiB", {{"budget", most_bytes / double{1 << 20}}}, [](const Part& p, std::size_t i) {
    return static_cast<double>(p.frames[i].resident_bytes) / (1 << 20);
  });
  panel("error in the picture", "px", {}, [](const Part& p, std::size_t i) { return p.frames[i].achieved; });
  chart.panels.back().y.logarithmic = true;
  return chart;
}

}  // namespace

int main(int argc, char** argv) {
  if (argc < 3) {
    fmt::print(stderr, "usage: cuesta-bench-route FILE.cuesta FLIGHT.json [NAME [TAU_PX]]\n");
    return 1;
  }
  const std::string name = argc > 3 ? argv[3] : "route";
  const Flight flight = must(read_flight(argv[2]));
  std::FILE* csv = std::fopen((name + ".csv").c_str(), "w");
  if (!csv) {
    fmt::print(stderr, "cuesta-bench-route: {}.csv: cannot be written\n", name);
    return 1;
  }
  print_head(csv);
  std::vector<Part> parts;
  bool held = true;
  for (const Speed& speed : speeds) {
    parts.push_back(fly(argv[1], flight, speed, argc > 4 ? std::atof(argv[4]) : 1));
    print_part(parts.back(), csv);
    for (const AdaptReport& r : parts.back().frames)
      held = held && r.triangles <= most_triangles && r.resident_bytes <= most_bytes;
  }
  std::fclose(csv);
  if (auto r = plot::write_svg(name + ".svg", chart_of(parts)); !r) {
    fmt::print(stderr, "cuesta-bench-route: {}\n", r.error().text());
    return 1;
  }
  fmt::print("# budgets of triangles and bytes {}\n", held ? "held in every frame" : "EXCEEDED");
  return held ? 0 : 1;
}
