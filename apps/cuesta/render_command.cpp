#include "apps/cuesta/render_command.h"

#include <fmt/format.h>

#include "apps/cuesta/frame_table.h"
#include "apps/cuesta/machine.h"
#include "apps/cuesta/open_cut.h"
#include "apps/cuesta/scene_render.h"
#include "apps/cuesta/stop_signal.h"
#include "apps/cuesta/terrain_settings.h"
#include "apps/cuesta/video_file.h"
#include "apps/overview/sketch.h"
#include "ooc/container_file.h"
#include "runtime/draw/png_file.h"
#include "runtime/flight_file.h"

namespace cuesta::app {
namespace {

/// A cut, a renderer unless only numbers are wanted, and what they have in common over frames.
class Pictures {
 public:
  static Result<Pictures> open(const RenderSettings& s) {
    auto ahead_ms = std::make_shared<double>(0);
    auto cut = open_cut(s.file, s.cache_bytes, s.load_threads, [ahead_ms] { return clock_ms() + *ahead_ms; });
    if (!cut) return fail(cut.error());
    auto look = look_of((*cut)->directory(), s.file, s.shading, s.exaggeration);
    if (!look) return fail(look.error());
    (*cut)->set_visual_error({s.visual_factor, {}});
    Pictures pictures(s, std::move(*cut), std::move(*look));
    pictures.cut_->set_tagging(pictures.draw_.shading == Shading::changes);
    pictures.ahead_ms_ = std::move(ahead_ms);
    if (s.stats_only) return pictures;
    auto context = make_offscreen_context(s.context);
    if (!context) return fail(context.error());
    auto renderer = Renderer::create(std::move(*context));
    if (!renderer) return fail(renderer.error());
    pictures.renderer_ = std::move(*renderer);
    if (!s.quiet) fmt::print(stderr, "drawn with {}\n", pictures.renderer_->driver());
    return pictures;
  }

  Cut& cut() { return *cut_; }
  const std::optional<terrain_view::TerrainLook>& look() const { return look_; }

  /// It is `time_s` now, for what takes time: blends last as long in the pictures however long those take.
  void set_time(double time_s) { *ahead_ms_ = time_s * 1000 - clock_ms(); }

  /// Adapts to `view`: at once, or as far as one frame's budgets go.
  Result<AdaptReport> adapt(const View& view, bool settle, Progress& progress) {
    const Grid& grid = cut_->directory().grid;
    auto scale = ErrorScale::perspective(grid, view, s_.outside_factor);
    if (draw_.relief) scale = scale.exaggerated(grid, *draw_.relief);
    cut_->set_geomorph_ms(settle ? 0 : s_.geomorph_ms);
    if (!settle) {
      AdaptReport report = cut_->adapt(scale, s_.tau_px, s_.budgets);
      report.achieved = cut_->achieved(scale);
      return report;
    }
    Budgets budgets;
    budgets.triangles = s_.budgets.triangles;
    return settle_cut(*cut_, scale, s_.tau_px, budgets, progress);
  }

  /// What is drawn, and how long that took.
  struct Drawn {
    Picture picture;
    double ms = 0;
  };
  /// An empty picture if only numbers are wanted.
  Result<Drawn> draw(const View& view) {
    if (!renderer_) return Drawn{};
    const double start = clock_ms();
    if (auto r = renderer_->draw(cut_->draw_list(), view, draw_); !r) return fail(r.error());
    auto picture = renderer_->read();
    if (!picture) return fail(picture.error());
    return Drawn{std::move(*picture), clock_ms() - start};
  }

  const PageCache& cache() const { return cut_->cache(); }

 private:
  Pictures(const RenderSettings& s, std::unique_ptr<Cut> cut, std::optional<terrain_view::TerrainLook> look)
      : s_(s), draw_(s.draw), cut_(std::move(cut)), look_(std::move(look)) {
    draw_.shading = shading_of(s.shading, look_);
    if (look_) terrain_view::set_look(*look_, draw_);
  }
  const RenderSettings& s_;
  DrawOptions draw_;
  std::unique_ptr<Cut> cut_;
  std::optional<terrain_view::TerrainLook> look_;  ///< of terrain
  std::unique_ptr<Renderer> renderer_;
  std::shared_ptr<double> ahead_ms_;  ///< of the clock that the cut has
};

View still_view(const RenderSettings& s, Pictures& pictures) {
  if (s.camera) return camera_view(*s.camera, s.view, s.up_given, pictures.look());
  return first_view(pictures.cut(), s.up_given ? std::nullopt : pictures.look(), s.view);
}

Result<void> render_still(const RenderSettings& s, Pictures& pictures, Progress& progress) {
  const View view = still_view(s, pictures);
  const auto report = pictures.adapt(view, true, progress);
  if (!report) return fail(report.error());
  const auto path = s.output.empty() ? s.file.filename().replace_extension(".png") : s.output;
  progress.update("draw", Unit::none, 0, 0);
  const auto drawn = pictures.draw(view);
  if (!drawn) return fail(drawn.error());
  if (!s.stats_only)
    if (auto r = write_png(path, drawn->picture); !r) return r;
  progress.finish();
  fmt::print("{}: {} triangles, {:.3g} px error, {} resident{}\n",
             s.stats_only ? s.file.string() : path.string(), with_commas(report->triangles), report->achieved,
             byte_count(report->resident_bytes),
             report->bound_by == Binding::nothing ? "" : fmt::format("; {} bound", name(report->bound_by)));
  return {};
}

Result<Flight> chosen_flight(const RenderSettings& s, Pictures& pictures) {
  if (!s.flight.empty()) return read_flight(s.flight);
  auto points = sketch_points(pictures.cut());
  const View view = orbit_view(points, s.view, s.up_given, pictures.look());
  if (pictures.look())
    for (Vec3d& p : points) p = pictures.look()->relief.raised(p);
  return make_flight(FlightKind::orbit, {points, points.front()}, view, s.orbit_frames + 1);
}

Result<void> make_folder(const std::filesystem::path& folder) {
  std::error_code error;
  std::filesystem::create_directories(folder, error);
  if (error) return fail(ErrorCode::io, folder.string(), "", "the folder cannot be made: " + error.message());
  return {};
}

Result<void> render_frames(const RenderSettings& s, const Flight& flight, std::uint64_t count,
                           FrameFiles& files, Pictures& pictures, Progress& progress,
                           std::vector<FrameRecord>& frames) {
  Progress silent(true);
  for (std::uint64_t i = 0; i < count; ++i) {
    if (!progress.update("frames", Unit::frames, i, count)) return check_stop();
    FrameRecord record;
    record.time_s = frame_time(flight, i);
    const View view = flight_view(flight, record.time_s, s.view);
    pictures.set_time(record.time_s);
    const auto report = pictures.adapt(view, i == 0 || s.settle, silent);
    if (!report) return fail(report.error());
    record.adapt = *report;
    const auto drawn = pictures.draw(view);
    if (!drawn) return fail(drawn.error());
    if (!s.stats_only)
      if (auto r = files.write(i, drawn->picture); !r) return r;
    record.render_ms = drawn->ms;
    frames.push_back(record);
  }
  return files.video ? files.video->finish() : Result<void>{};
}

void tell_flight(const std::filesystem::path& where, const std::vector<FrameRecord>& frames,
                 const Pictures& p) {
  std::uint64_t most = 0;
  double slowest = 0;
  for (std::size_t i = 0; i < frames.size(); ++i) {
    most = std::max(most, frames[i].adapt.triangles);
    if (i > 0) slowest = std::max(slowest, frames[i].adapt.adapt_ms);
  }
  fmt::print("{}: {} frames, at most {} triangles, adapt at most {:.2f} ms, {} page loads, {} evictions\n",
             where.string(), frames.size(), with_commas(most), slowest,
             with_commas(p.cache().counters().loads), with_commas(p.cache().counters().evictions));
  for (const Error& error : p.cache().errors())
    fmt::print(stderr, "cuesta: drawn coarser: {}\n", error.text());
}

Result<void> render_flight(const RenderSettings& s, Pictures& pictures, Progress& progress) {
  const auto flight = chosen_flight(s, pictures);
  if (!flight) return fail(flight.error());
  // An orbit ends where it began: its last frame is the first again.
  const std::uint64_t count = s.flight.empty() ? s.orbit_frames : frame_count(*flight);
  auto files = open_frame_files(s, *flight);
  if (!files) return fail(files.error());
  std::vector<FrameRecord> frames;
  if (auto r = render_frames(s, *flight, count, *files, pictures, progress, frames); !r) return r;
  progress.finish();
  if (!files->folder.empty()) {
    if (auto r = write_text(files->folder / "frames.csv", frames_csv(frames)); !r) return r;
    const FrameLimits limits{s.budgets, s.tau_px, s.cache_bytes};
    if (auto r = write_frames_plot(files->folder / "frames.svg", s.file.filename().string(), frames, limits);
        !r)
      return r;
  }
  tell_flight(files->folder.empty() ? s.video : files->folder, frames, pictures);
  return {};
}

/// The pictures are there, but coarser than asked where pages could not be read: an error all the same.
Result<void> unread_pages(const Pictures& pictures) {
  const auto errors = pictures.cache().errors();
  if (errors.empty()) return {};
  Error error = errors.front();
  error.message +=
      fmt::format("; {} pages could not be read, and the pictures are coarser there", errors.size());
  return fail(error);
}

}  // namespace

Result<void> FrameFiles::write(std::uint64_t frame, const Picture& picture) {
  if (!folder.empty())
    if (auto r = write_png(folder / fmt::format("frame-{:05}.png", frame), picture); !r) return r;
  return video ? video->add(picture) : Result<void>{};
}

Result<FrameFiles> open_frame_files(const RenderSettings& s, const Flight& flight) {
  FrameFiles files;
  if (s.output.empty() && s.video.empty()) files.folder = s.file.stem().string() + "-frames";
  if (!s.output.empty()) files.folder = s.output;
  if (!files.folder.empty())
    if (auto r = make_folder(files.folder); !r) return fail(r.error());
  if (s.video.empty() || s.stats_only) return files;
  auto video = VideoFile::create(s.video, s.view.width_px, s.view.height_px, flight.fps);
  if (!video) return fail(video.error());
  files.video.emplace(std::move(*video));
  return files;
}

Result<void> run_render(const RenderSettings& settings) {
  const auto kind = ContainerReader::kind_of(settings.file);
  if (!kind) return fail(kind.error());
  if (*kind == ContainerKind::scene) return run_scene_render(settings);
  Progress progress(settings.quiet);
  auto pictures = Pictures::open(settings);
  if (!pictures) return fail(pictures.error());
  const bool still = settings.flight.empty() && settings.orbit_frames == 0;
  const auto done =
      still ? render_still(settings, *pictures, progress) : render_flight(settings, *pictures, progress);
  return done ? unread_pages(*pictures) : done;
}

}  // namespace cuesta::app
