#include "apps/cuesta/render_command.h"

#include <fmt/format.h>

#include "apps/cuesta/frame_table.h"
#include "apps/cuesta/machine.h"
#include "apps/cuesta/open_cut.h"
#include "apps/cuesta/stop_signal.h"
#include "runtime/draw/png_file.h"
#include "runtime/flight_file.h"
#include "runtime/view_fit.h"

namespace cuesta::app {
namespace {

/// A cut, a renderer unless only numbers are wanted, and what they have in common over frames.
class Pictures {
 public:
  static Result<Pictures> open(const RenderSettings& s) {
    auto cut = open_cut(s.file, s.cache_bytes);
    if (!cut) return fail(cut.error());
    Pictures pictures(s, std::move(*cut));
    if (s.stats_only) return pictures;
    auto context = make_osmesa_context();
    if (!context) return fail(context.error());
    auto renderer = Renderer::create(std::move(*context));
    if (!renderer) return fail(renderer.error());
    pictures.renderer_ = std::move(*renderer);
    return pictures;
  }

  std::vector<Vec3d> sketch() { return sketch_points(*cut_); }

  /// Adapts to `view`: at once, or as far as one frame's budgets go.
  Result<AdaptReport> adapt(const View& view, bool settle, Progress& progress) {
    const auto scale = ErrorScale::perspective(cut_->directory().grid, view, s_.outside_factor);
    if (!settle) return cut_->adapt(scale, s_.tau_px, s_.budgets);
    Budgets budgets;
    budgets.triangles = s_.budgets.triangles;
    return settle_cut(*cut_, scale, s_.tau_px, budgets, progress);
  }

  /// Draws and writes. @return milliseconds of drawing.
  Result<double> draw(const View& view, const std::filesystem::path& path) {
    if (!renderer_) return 0.0;
    const double start = clock_ms();
    if (auto r = renderer_->draw(cut_->draw_list(), view, s_.draw); !r) return fail(r.error());
    const auto picture = renderer_->read();
    if (!picture) return fail(picture.error());
    const double drawn = clock_ms() - start;
    if (auto r = write_png(path, *picture); !r) return fail(r.error());
    return drawn;
  }

  const PageCache& cache() const { return cut_->cache(); }

 private:
  Pictures(const RenderSettings& s, std::unique_ptr<Cut> cut) : s_(s), cut_(std::move(cut)) {}
  const RenderSettings& s_;
  std::unique_ptr<Cut> cut_;
  std::unique_ptr<Renderer> renderer_;
};

View still_view(const RenderSettings& s, Pictures& pictures) {
  if (!s.camera) return fit_view(pictures.sketch(), three_quarter_direction(s.view.up), s.view);
  View view = s.view;
  view.eye = s.camera->eye;
  view.target = s.camera->target;
  view.up = s.camera->up.value_or(view.up);
  return view;
}

Result<void> render_still(const RenderSettings& s, Pictures& pictures, Progress& progress) {
  const View view = still_view(s, pictures);
  const auto report = pictures.adapt(view, true, progress);
  if (!report) return fail(report.error());
  const auto path = s.output.empty() ? s.file.filename().replace_extension(".png") : s.output;
  progress.update("draw", Unit::none, 0, 0);
  const auto drawn = pictures.draw(view, path);
  if (!drawn) return fail(drawn.error());
  progress.finish();
  fmt::print("{}: {} triangles, {:.3g} px error, {} resident{}\n",
             s.stats_only ? s.file.string() : path.string(), with_commas(report->triangles), report->achieved,
             byte_count(report->resident_bytes),
             report->bound_by == Binding::nothing ? "" : fmt::format("; {} bound", name(report->bound_by)));
  return {};
}

Result<Flight> chosen_flight(const RenderSettings& s, Pictures& pictures) {
  if (!s.flight.empty()) return read_flight(s.flight);
  const auto points = pictures.sketch();
  return make_flight(FlightKind::orbit, {points, points.front()}, s.view, s.orbit_frames + 1);
}

Result<void> make_folder(const std::filesystem::path& folder) {
  std::error_code error;
  std::filesystem::create_directories(folder, error);
  if (error) return fail(ErrorCode::io, folder.string(), "", "the folder cannot be made: " + error.message());
  return {};
}

Result<void> render_frames(const RenderSettings& s, const Flight& flight, std::uint64_t count,
                           const std::filesystem::path& folder, Pictures& pictures, Progress& progress,
                           std::vector<FrameRecord>& frames) {
  Progress silent(true);
  for (std::uint64_t i = 0; i < count; ++i) {
    if (!progress.update("frames", Unit::frames, i, count)) return check_stop();
    FrameRecord record;
    record.time_s = frame_time(flight, i);
    const View view = flight_view(flight, record.time_s, s.view);
    const auto report = pictures.adapt(view, i == 0 || s.settle, silent);
    if (!report) return fail(report.error());
    record.adapt = *report;
    const auto drawn = pictures.draw(view, folder / fmt::format("frame-{:05}.png", i));
    if (!drawn) return fail(drawn.error());
    record.render_ms = *drawn;
    frames.push_back(record);
  }
  return {};
}

void tell_flight(const std::filesystem::path& folder, const std::vector<FrameRecord>& frames,
                 const Pictures& p) {
  std::uint64_t most = 0;
  double slowest = 0;
  for (std::size_t i = 0; i < frames.size(); ++i) {
    most = std::max(most, frames[i].adapt.triangles);
    if (i > 0) slowest = std::max(slowest, frames[i].adapt.adapt_ms);
  }
  fmt::print("{}: {} frames, at most {} triangles, adapt at most {:.2f} ms, {} page loads, {} evictions\n",
             folder.string(), frames.size(), with_commas(most), slowest,
             with_commas(p.cache().counters().loads), with_commas(p.cache().counters().evictions));
  for (const Error& error : p.cache().errors())
    fmt::print(stderr, "cuesta: drawn coarser: {}\n", error.text());
}

Result<void> render_flight(const RenderSettings& s, Pictures& pictures, Progress& progress) {
  const auto flight = chosen_flight(s, pictures);
  if (!flight) return fail(flight.error());
  // An orbit ends where it began: its last frame is the first again.
  const std::uint64_t count = s.flight.empty() ? s.orbit_frames : frame_count(*flight);
  const auto folder = s.output.empty() ? std::filesystem::path(s.file.stem().string() + "-frames") : s.output;
  if (auto r = make_folder(folder); !r) return r;
  std::vector<FrameRecord> frames;
  if (auto r = render_frames(s, *flight, count, folder, pictures, progress, frames); !r) return r;
  progress.finish();
  if (auto r = write_text(folder / "frames.csv", frames_csv(frames)); !r) return r;
  const FrameLimits limits{s.budgets, s.tau_px, s.cache_bytes};
  if (auto r = write_frames_plot(folder / "frames.svg", s.file.filename().string(), frames, limits); !r)
    return r;
  tell_flight(folder, frames, pictures);
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

Result<void> run_render(const RenderSettings& settings) {
  Progress progress(settings.quiet);
  auto pictures = Pictures::open(settings);
  if (!pictures) return fail(pictures.error());
  const bool still = settings.flight.empty() && settings.orbit_frames == 0;
  const auto done =
      still ? render_still(settings, *pictures, progress) : render_flight(settings, *pictures, progress);
  return done ? unread_pages(*pictures) : done;
}

}  // namespace cuesta::app
