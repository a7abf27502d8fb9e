// cuesta-bench-scene FILE.cuesta --name NAME [options]: a recorded walk-through of a scene at 100, 33 and 16
// ms with each policy, drawn by OSMesa in one thread; times are that thread's. The way: around the scene
// once, then into its middle, quick turns there and out again, so that objects enter and leave the view
// abruptly.
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <cstdio>
#include <cstdlib>
#include <ctime>

#include "apps/plot/svg_plot.h"
#include "apps/scene_show/scene_frames.h"
#include "runtime/flight.h"

namespace {

using namespace cuesta;
using namespace cuesta::scene_show;

struct Settings {
  std::filesystem::path file, csv, plots;
  std::string name;
  std::uint32_t width = 640, height = 360, frames = 300;
  std::uint64_t cache_mib = 1024;
  std::vector<double> deadlines{100, 33, 16};
  bool moving = false, cold = false;
};

/// Processor time of this thread, which also draws (LP_NUM_THREADS=0): what a frame costs on one core,
/// whatever else the machine does.
double clock_ms() {
  timespec t{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &t);
  return static_cast<double>(t.tv_sec) * 1e3 + static_cast<double>(t.tv_nsec) * 1e-6;
}

template <class T>
T value_of(Result<T> result) {
  if (result) return std::move(*result);
  fmt::print(stderr, "cuesta-bench-scene: {}\n", result.error().text());
  std::exit(exit_status(result.error().code));
}

View sized(const Settings& s) {
  View view;
  view.width_px = static_cast<int>(s.width), view.height_px = static_cast<int>(s.height);
  return view;
}

Flight walk(const ScenePlayer& player, const Settings& s) {
  constexpr double seconds = 10;
  const auto points = player.sketch();
  return make_flight(FlightKind::walk_through, {points, points.front()}, sized(s), s.frames + 1,
                     s.frames / seconds);
}

/// One instance in ten swings about where it is.
void swing(LiveScene& scene, std::span<const SceneNode> nodes, double size, double time_s) {
  for (std::size_t i = 0; i < scene.instances().size(); i += 10) {
    const std::uint32_t node = scene.instances()[i].node;
    Affine local = affine_of(nodes[node].local);
    local.translation = local.translation + Vec3d{0, 0.02 * size * std::sin(3 * time_s + double(i)), 0};
    scene.pose().set_local(node, local);
  }
}

std::vector<PlayedFrame> play(const Settings& s, PolicyKind policy, double deadline_ms) {
  PlayerSettings settings;
  settings.scene.policy = policy;
  settings.scene.cache_bytes = s.cache_mib << 20;
  settings.draw.antialias = false;
  settings.draw.surface_colour = {255, 255, 255, 255};
  const auto player = value_of(ScenePlayer::open(s.file, settings, clock_ms));
  if (auto ok = player->draw_into(value_of(make_osmesa_context())); !ok) value_of<int>(fail(ok.error()));
  const Flight flight = walk(*player, s);
  SceneFrameOptions options;
  options.deadline_ms = deadline_ms;
  options.most_choice_ms = 0.1 * deadline_ms;
  std::vector<View> views;
  for (const double at : {0.0, 0.4, 0.47, 0.8}) views.push_back(flight_view(flight, at * 10, sized(s)));
  if (s.cold) views.resize(1);
  if (auto ok = player->calibrate(views, options); !ok) value_of<int>(fail(ok.error()));
  const double size = length(player->scene().bounds().hi - player->scene().bounds().lo);
  std::vector<PlayedFrame> frames;
  for (std::uint64_t i = 0; i < frame_count(flight); ++i) {
    const double t = frame_time(flight, i);
    if (s.moving) swing(player->scene(), player->file().nodes(), size, t);
    frames.push_back(value_of(player->play(flight_view(flight, t, sized(s)), options, t)));
  }
  return frames;
}

/// Frames in which at least a quarter more objects are visible than in the one before, and the one after.
double late_on_entry(std::span<const PlayedFrame> frames) {
  std::uint32_t entries = 0, late = 0;
  for (std::size_t i = 1; i < frames.size(); ++i) {
    if (double(frames[i].report.visible_triangles) < 1.25 * double(frames[i - 1].report.visible_triangles))
      continue;
    ++entries;
    late += frames[i].actual_ms > frames[i].report.desired_ms ? 1 : 0;
  }
  return entries > 0 ? double(late) / entries : 0;
}

}  // namespace

int main(int argc, char** argv) {
  setenv("LP_NUM_THREADS", "0", 1);
  Settings s;
  CLI::App app("Walks through a scene under deadlines, with each policy");
  app.add_option("FILE", s.file)->required();
  app.add_option("--name", s.name)->required();
  app.add_option("--csv", s.csv, "append rows to it");
  app.add_option("--plots", s.plots, "folder for a plot of each walk");
  app.add_option("--width", s.width);
  app.add_option("--height", s.height);
  app.add_option("--frames", s.frames);
  app.add_option("--cache-mib", s.cache_mib);
  app.add_option("--deadlines", s.deadlines);
  app.add_flag("--moving", s.moving, "one object in ten swings");
  app.add_flag("--cold", s.cold, "calibrate from the first view alone, so that the rest streams in");
  CLI11_PARSE(app, argc, argv);
  std::FILE* const csv = s.csv.empty() ? nullptr : std::fopen(s.csv.c_str(), "a");
  for (const double deadline : s.deadlines)
    for (const PolicyKind policy : {PolicyKind::predictive, PolicyKind::stress, PolicyKind::fixed}) {
      const auto frames = play(s, policy, deadline);
      const DeadlineSummary sum = summarise(frames);
      std::uint32_t infeasible = 0, most_missing = 0;
      double optimisation = 0;
      for (const PlayedFrame& f : frames) {
        infeasible += f.report.outcome == ResolutionOutcome::infeasible ? 1 : 0;
        most_missing = std::max(most_missing, f.report.store.missing);
        optimisation = std::max(optimisation, f.report.optimisation_ms);
      }
      const std::string row = fmt::format(
          "{},{},{:.4g},{},{:.4f},{:.4f},{:.2f},{:.2f},{:.2f},{:.3f},{:.0f},{:.3f},{:.3f},{},{}\n", s.name,
          scene_show::name(policy), deadline, frames.size(), sum.within_share, sum.median_error,
          sum.median_ms, sum.p99_ms, sum.most_ms, sum.mean_use, sum.median_triangles, late_on_entry(frames),
          optimisation, infeasible, most_missing);
      fmt::print("{}", row);
      std::fflush(stdout);
      if (csv) std::fputs(row.c_str(), csv);
      if (s.plots.empty()) continue;
      const std::string title = fmt::format("{}, {}, {:.4g} ms", s.name, scene_show::name(policy), deadline);
      const auto path =
          s.plots / fmt::format("scene_{}_{}_{:.0f}.svg", s.name, scene_show::name(policy), deadline);
      if (auto ok = write_scene_plot(path, title, "walk-through, software renderer", frames); !ok)
        value_of<int>(fail(ok.error()));
    }
  if (csv) std::fclose(csv);
}
