// cuesta-bench-frames cost FILE.cuesta [CSV]: what a frame costs on a cut of a million triangles (issue of
// adapt
//   following change): a still camera, a slow flight, one core.
// cuesta-bench-frames budgets FILE.cuesta [CSV [TAU_PX]]: 3,000 frames, slow, fast and teleporting, with a
// cache of 256 MiB, 4 ms
//   and a million triangles; then the camera stops, and the cut is compared with a fresh start's.
#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <map>
#include <random>
#include <thread>

#include "runtime/cut.h"
#include "runtime/extract.h"
#include "runtime/flight.h"
#include "runtime/view_fit.h"
#include "tools/bench/frame_figures.h"

namespace {

using namespace cuesta;
using namespace cuesta::bench;

constexpr std::uint64_t million = 1'000'000;

std::unique_ptr<Cut> open(const char* path, std::uint64_t cache, std::uint32_t threads,
                          Clock clock = clock_ms) {
  auto file = CuestaFile::open(path);
  auto cut = file ? Cut::open(std::move(*file), cache, std::move(clock), threads) : fail(file.error());
  if (cut) return std::move(*cut);
  fmt::print(stderr, "cuesta-bench-frames: {}\n", cut.error().text());
  std::exit(1);
}

std::vector<Vec3d> coarse_points(const char* path) {
  const auto cut = open(path, std::uint64_t{1} << 30, 0);
  Budgets budgets;
  budgets.page_loads = 0;
  cut->adapt(ErrorScale::uniform(cut->directory().grid), 0, budgets);
  return extract_mesh(cut->draw_list(), {false, false}).value().positions;
}

View full_hd() {
  View view;
  view.width_px = 1920;
  view.height_px = 1080;
  return view;
}

/// Over the model from end to end, at 30 frames a second, in so many frames.
Flight over(std::span<const Vec3d> points, std::uint64_t frames) {
  return make_flight(FlightKind::fly_over, {points, points.front()}, full_hd(), frames);
}

void print_histogram(const Part& part) {
  std::map<int, int> bins;
  for (const AdaptReport& r : part.frames) ++bins[std::min(static_cast<int>(r.adapt_ms * 2), 20)];
  for (const auto& [bin, count] : bins)
    fmt::print("  {:4.1f} - {:4.1f} ms {:5} {}\n", bin / 2.0, bin / 2.0 + 0.5, count,
               std::string(count / 20, '#'));
}

/// A sweep of all blocks, as after a jump of the threshold: wall time, on one thread and on all.
void print_sweeps(Cut& cut, const ErrorScale& scale, double tau) {
  for (const bool parallel : {false, true}) {
    cut.set_parallel(parallel);
    std::vector<double> ms;
    std::uint32_t blocks = 0;
    for (int i = 0; i < 11; ++i) {
      const double start = parallel ? clock_ms() : thread_ms();
      const AdaptReport r = cut.adapt(scale, tau * (1 + 1e-5 * (i % 2)), {});
      ms.push_back((parallel ? clock_ms() : thread_ms()) - start);
      blocks = r.blocks_tested;
    }
    fmt::print("# all {} blocks, {}: {:.2f} ms\n", blocks, parallel ? "in parallel, wall" : "one thread",
               quantile(ms, 0.5));
  }
  cut.set_parallel(false);
}

int cost(const char* path, std::FILE* csv) {
  const auto points = coarse_points(path);
  const auto cut = open(path, std::uint64_t{4} << 30, 0, thread_ms);
  // A frame is 1/30 s; the slow flight takes 33 s over the model.
  const Flight flight = over(points, 1000);
  const Grid& grid = cut->directory().grid;
  const auto scale = [&](double frame) {
    return ErrorScale::perspective(grid, flight_view(flight, frame / flight.fps, full_hd()), 4);
  };
  Budgets budgets;
  budgets.triangles = million;
  const AdaptReport first = cut->settle(scale(400), 0.05, budgets);
  fmt::print("# {}: {} triangles; cut of {} at tau {:.3f} px, {} pages, {:.0f} MiB\n", path,
             cut->directory().triangles, first.triangles, first.tau, cut->cache().resident_ids().size(),
             static_cast<double>(first.resident_bytes) / (1 << 20));
  std::uint64_t real = 0, worst = 0;
  for (const PageId id : cut->cache().resident_ids()) {
    const PageEntry& e = cut->directory().pages[id];
    const std::uint64_t bytes = cut->cache().resident(id)->bytes() +
                                GeometryPool::page_bytes(e.owned_vertices, e.owned_triangles, false);
    real += bytes;
    worst = std::max(worst, bytes * 1000 / cut->cache().charge(id));
  }
  fmt::print("# pages take {:.0f} MiB, a page at most {:.2f} of its charge\n",
             static_cast<double>(real) / (1 << 20), static_cast<double>(worst) / 1000);
  const double tau = first.tau;
  budgets.triangles = std::numeric_limits<std::uint64_t>::max();
  cut->settle(scale(400), tau, budgets);
  print_head(csv);
  Part still{"still", {}}, slow{"slow", {}}, very_slow{"a tenth as fast", {}};
  for (int i = 0; i < 300; ++i) still.frames.push_back(cut->adapt(scale(400), tau, budgets));
  for (int i = 1; i <= 300; ++i) {
    slow.frames.push_back(cut->adapt(scale(400 + i * 0.5), tau, budgets));
    cut->draw_list();
  }
  for (int i = 1; i <= 300; ++i) {
    very_slow.frames.push_back(cut->adapt(scale(550 + i * 0.05), tau, budgets));
    cut->draw_list();
  }
  print_sweeps(*cut, scale(565), tau);
  for (const Part* p : {&still, &slow, &very_slow}) print_part(*p, csv);
  return 0;
}

/// Applied substitutions of every fan that is not wholly applied: equal where the cuts are.
using State = std::map<std::pair<PageId, std::uint32_t>, std::uint16_t>;
State state_of(const Cut& cut) {
  State state;
  for (const PageId id : cut.cache().resident_ids()) {
    const ResidentPage& page = *cut.cache().resident(id);
    for (std::uint32_t f = 0; f < page.fans().size(); ++f)
      if (page.fans()[f].applied < page.fans()[f].child_count) state[{id, f}] = page.fans()[f].applied;
  }
  return state;
}

int budgets(const char* path, double tau, std::FILE* csv) {
  const auto points = coarse_points(path);
  constexpr std::uint64_t cache = std::uint64_t{256} << 20;
  const auto cut = open(path, cache, 1);
  const Grid& grid = cut->directory().grid;
  Budgets budgets;
  budgets.adapt_ms = 4;
  budgets.triangles = million;
  budgets.upload_bytes = std::uint64_t{4} << 20;
  const Flight slow = over(points, 2000), fast = over(points, 100);
  std::mt19937 random(1);
  View view = full_hd();
  const auto next_view = [&](int part, int frame) {
    const Flight& flight = part == 0 ? slow : part == 1 ? fast : slow;
    const double frames = static_cast<double>(frame_count(flight) - 1);
    double at = part == 0 ? 500 + frame : std::fmod(frame, frames);
    if (part == 2 && frame % 15 != 0) return view;
    if (part == 2) at = frames * static_cast<double>(random() % 1000) / 1000;
    return flight_view(flight, at / flight.fps, full_hd());
  };
  print_head(csv);
  bool held = true;
  std::vector<Part> parts{{"slow", {}}, {"fast", {}}, {"teleporting", {}}};
  Part all{"all", {}};
  for (int p = 0; p < 3; ++p) {
    for (int i = 0; i < 1000; ++i) {
      view = next_view(p, i);
      const double before = thread_ms();
      const AdaptReport r = cut->adapt(ErrorScale::perspective(grid, view, 4), tau, budgets);
      parts[p].processor_ms.push_back(thread_ms() - before);
      all.processor_ms.push_back(parts[p].processor_ms.back());
      cut->draw_list();
      parts[p].frames.push_back(r);
      all.frames.push_back(r);
      held = held && r.triangles <= budgets.triangles && r.resident_bytes <= cache;
      // What drawing would take: the loader has the other core meanwhile.
      std::this_thread::sleep_for(std::chrono::milliseconds(8));
    }
    print_part(parts[p], csv);
  }
  print_part(all, csv);
  print_histogram(all);
  const auto& counters = cut->cache().counters();
  fmt::print("# loads {} (prefetched {}), evictions {}, refused {}, failed {}\n", counters.loads,
             counters.prefetched, counters.evictions, counters.refused_for_budget, counters.failed);
  const ErrorScale last = ErrorScale::perspective(grid, view, 4);
  const double start = clock_ms();
  AdaptReport report;
  int calls = 0;
  do {
    report = cut->adapt(last, tau, budgets);
    cut->draw_list();
    std::this_thread::sleep_for(std::chrono::milliseconds(8));
  } while (!report.settled && ++calls < 2000);
  const double stopped = clock_ms() - start;
  const auto fresh = open(path, cache, 1);
  const AdaptReport from_fresh = fresh->settle(last, tau, budgets);
  const bool same = state_of(*cut) == state_of(*fresh) && report.triangles == from_fresh.triangles;
  fmt::print("# at rest after {:.2f} s and {} calls: {} triangles at tau {:.4f}; fresh: {} at {:.4f}: {}\n",
             stopped / 1000, calls, report.triangles, report.tau, from_fresh.triangles, from_fresh.tau,
             same ? "the same cut" : "ANOTHER CUT");
  fmt::print("# budgets of triangles and bytes {}\n", held ? "held in every frame" : "EXCEEDED");
  return held && same ? 0 : 1;
}

}  // namespace

int main(int argc, char** argv) {
  if (argc < 3) {
    fmt::print(stderr, "usage: cuesta-bench-frames cost|budgets FILE.cuesta [CSV [TAU_PX]]\n");
    return 1;
  }
  std::FILE* csv = argc > 3 ? std::fopen(argv[3], "w") : nullptr;
  const int status = std::strcmp(argv[1], "cost") == 0
                         ? cost(argv[2], csv)
                         : budgets(argv[2], argc > 4 ? std::atof(argv[4]) : 1, csv);
  if (csv) std::fclose(csv);
  return status;
}
