#include "apps/cuesta/scene_render.h"

#include <fmt/format.h>

#include "apps/cuesta/frame_table.h"
#include "apps/cuesta/machine.h"
#include "apps/cuesta/open_cut.h"
#include "apps/cuesta/scene_settings.h"
#include "apps/cuesta/stop_signal.h"
#include "apps/cuesta/terrain_settings.h"
#include "apps/cuesta/video_file.h"
#include "apps/scene_show/scene_frames.h"
#include "runtime/draw/png_file.h"
#include "runtime/flight_file.h"
#include "runtime/view_fit.h"

namespace cuesta::app {
namespace {

using scene_show::PlayedFrame;
using scene_show::ScenePlayer;

SceneFrameOptions frame_options(const RenderSettings& s) {
  SceneFrameOptions options;
  options.deadline_ms = s.deadline_ms;
  options.tau_px = std::max(s.tau_px, 1e-3);
  options.most_choice_ms = choice_share * s.deadline_ms;
  return options;
}

Result<std::unique_ptr<ScenePlayer>> open_player(const RenderSettings& s) {
  auto player = ScenePlayer::open(s.file, player_settings(s), clock_ms);
  if (!player || s.stats_only) return player;
  auto context = make_offscreen_context(s.context);
  if (!context) return fail(context.error());
  if (auto r = (*player)->draw_into(std::move(*context)); !r) return fail(r.error());
  return player;
}

View still_view(const RenderSettings& s, const ScenePlayer& player) {
  if (s.camera) return camera_view(*s.camera, s.view, s.up_given, std::nullopt);
  return fit_view(player.sketch(), three_quarter_direction(s.view.up), s.view);
}

Result<void> render_still(const RenderSettings& s, ScenePlayer& player) {
  SceneFrameOptions options = frame_options(s);
  options.uniform = 1;
  const auto frame = player.settle(still_view(s, player), options);
  if (!frame) return fail(frame.error());
  const auto path = s.output.empty() ? s.file.filename().replace_extension(".png") : s.output;
  if (!s.stats_only) {
    const auto picture = player.picture();
    if (!picture) return fail(picture.error());
    if (auto r = write_png(path, *picture); !r) return r;
  }
  const SceneFrameReport& r = frame->report;
  fmt::print("{}: {} of {} triangles in {} objects, {} resident\n",
             s.stats_only ? s.file.string() : path.string(), with_commas(r.drawn_triangles),
             with_commas(r.visible_triangles), with_commas(r.drawn_objects),
             byte_count(r.store.resident_bytes + r.surface_bytes));
  return {};
}

Result<Flight> chosen_flight(const RenderSettings& s, const ScenePlayer& player) {
  if (!s.flight.empty()) return read_flight(s.flight);
  const auto points = player.sketch();
  return make_flight(FlightKind::orbit, {points, points.front()}, s.view, s.orbit_frames + 1);
}

/// A quarter, half and three quarters on the way, and its ends.
std::vector<View> calibration_views(const RenderSettings& s, const Flight& flight) {
  std::vector<View> views;
  const double last = flight.keyframes.back().time_s;
  for (const double at : {0.0, 0.25, 0.5, 0.75, 1.0}) views.push_back(flight_view(flight, at * last, s.view));
  return views;
}

/// The first clip of the scene, again and again.
void move_parts(ScenePlayer& player, double time_s) {
  const auto clips = player.file().clips();
  if (clips.empty() || !(clips[0].seconds() > 0)) return;
  player.scene().pose().set_clip_time(0, std::fmod(time_s, clips[0].seconds()));
}

Result<std::vector<PlayedFrame>> play_flight(const RenderSettings& s, const Flight& flight,
                                             std::uint64_t count, ScenePlayer& player, FrameFiles& files) {
  Progress progress(s.quiet);
  std::vector<PlayedFrame> frames;
  for (std::uint64_t i = 0; i < count; ++i) {
    if (!progress.update("frames", Unit::frames, i, count)) return fail(check_stop().error());
    const double time_s = frame_time(flight, i);
    move_parts(player, time_s);
    const View view = flight_view(flight, time_s, s.view);
    auto frame =
        s.settle ? player.settle(view, frame_options(s)) : player.play(view, frame_options(s), time_s);
    if (!frame) return fail(frame.error());
    frame->time_s = time_s;
    frames.push_back(*frame);
    if (s.stats_only) continue;
    const auto picture = player.picture();
    if (!picture) return fail(picture.error());
    if (auto r = files.write(i, *picture); !r) return fail(r.error());
  }
  if (files.video)
    if (auto r = files.video->finish(); !r) return fail(r.error());
  progress.finish();
  return frames;
}

Result<void> tell_flight(const RenderSettings& s, const FrameFiles& files,
                         const std::vector<PlayedFrame>& frames) {
  const auto sum = scene_show::summarise(frames);
  const std::string told = fmt::format(
      "{}, {:.4g} ms: {:.1f} % of {} frames within, median {:.1f} ms, 99 % {:.1f} ms, prediction off by "
      "{:.1f} %",
      scene_show::name(s.policy), s.deadline_ms, 100 * sum.within_share, frames.size(), sum.median_ms,
      sum.p99_ms, 100 * sum.median_error);
  fmt::print("{}: {}\n", (files.folder.empty() ? s.video : files.folder).string(), told);
  if (files.folder.empty()) return {};
  if (auto r = write_text(files.folder / "frames.csv", scene_show::scene_frames_csv(frames)); !r) return r;
  return scene_show::write_scene_plot(files.folder / "frames.svg", s.file.filename().string(), told, frames);
}

Result<void> render_flight(const RenderSettings& s, ScenePlayer& player) {
  const auto flight = chosen_flight(s, player);
  if (!flight) return fail(flight.error());
  const std::uint64_t count = s.flight.empty() ? s.orbit_frames : frame_count(*flight);
  auto files = open_frame_files(s, *flight);
  if (!files) return fail(files.error());
  if (auto r = player.calibrate(calibration_views(s, *flight), frame_options(s)); !r) return r;
  const auto frames = play_flight(s, *flight, count, player, *files);
  if (!frames) return fail(frames.error());
  return tell_flight(s, *files, *frames);
}

/// The pictures are there, but coarser than asked where parts could not be read: an error all the same.
Result<void> unread_parts(ScenePlayer& player) {
  const auto errors = player.scene().store().errors();
  if (errors.empty()) return {};
  Error error = errors.front();
  error.message +=
      fmt::format("; {} parts could not be read whole, and are coarser in the pictures", errors.size());
  return fail(error);
}

}  // namespace

Result<void> run_scene_render(const RenderSettings& s) {
  auto player = open_player(s);
  if (!player) return fail(player.error());
  if ((*player)->renderer() && !s.quiet)
    fmt::print(stderr, "drawn with {}\n", (*player)->renderer()->driver());
  const bool still = s.flight.empty() && s.orbit_frames == 0;
  const auto done = still ? render_still(s, **player) : render_flight(s, **player);
  return done ? unread_parts(**player) : done;
}

}  // namespace cuesta::app
