/// Surfaces in a viewer: several files in one world, each with its cut; terrain with heights and places.

#include <fmt/format.h>

#include <cmath>
#include <utility>

#include "apps/cuesta/frame_table.h"
#include "apps/cuesta/open_cut.h"
#include "apps/cuesta/terrain_settings.h"
#include "apps/cuesta/view_subject.h"
#include "apps/overview/sketch.h"
#include "apps/view/budget_shares.h"
#include "apps/view/scene.h"
#include "apps/view/statistics_text.h"
#include "runtime/view_fit.h"

namespace cuesta::app {
namespace {

using view::Action;
using view::ControlMode;

constexpr double usual_geomorph_ms = 250;
constexpr double budget_factor = 1.4142135623730951;
constexpr std::uint64_t least_triangles = 1000;
constexpr double least_tau_px = 1.0 / 64, largest_tau_px = 64;
constexpr double exaggeration_factor = 1.25, least_exaggeration = 0.1, largest_exaggeration = 50;

class SurfaceSubject final : public ViewSubject {
 public:
  SurfaceSubject(const ViewSettings& settings, view::CameraControls& controls)
      : s_(settings),
        controls_(controls),
        tau_px_(settings.tau_px),
        geomorph_ms_(settings.geomorph_ms),
        budgets_(settings.budgets),
        draw_(settings.draw) {}
  Result<void> add_files(const std::vector<std::filesystem::path>& files);

  bool is_empty() const override { return scene_.objects().empty(); }
  std::string title() const override;
  Result<void> draw_into(std::unique_ptr<GlContext> context) override;
  std::vector<Vec3d> points() const override { return scene_.points(); }
  View first_view(const View& picture) const override;
  std::optional<Vec3d> hit(Vec3d origin, Vec3d direction) const override {
    return scene_.hit(origin, direction);
  }
  std::string add(const std::filesystem::path& file) override;
  std::string act(Action action) override;
  Taken take(const WindowEvent& event) override;
  Result<ViewedFrame> frame(const ViewMoment& moment) override;
  Result<void> show(int width_px, int height_px, std::span<const TextBlock> text, int text_scale) override {
    return renderer_->show(width_px, height_px, text, text_scale);
  }
  Result<Picture> read() override { return renderer_->read(); }
  std::vector<std::string> statistics(const ViewTimes& times) const override;
  void record_frames() override { recorded_.emplace(); }
  std::string take_frames_csv() override;
  std::vector<Error> errors() const override;

 private:
  Result<void> add_file(const std::filesystem::path& path, std::uint64_t cache_bytes);
  void take_look(terrain_view::TerrainLook look);
  void set_controls();
  std::string exaggerate(double factor);
  std::string change_tau(double factor);
  std::string change_triangles(double factor);
  std::string change_time(double factor);
  std::string toggle_geomorphs();
  void freeze();
  void shade(Shading shading);
  bool adapt(const ViewMoment& moment);
  Result<void> draw(double now_s);
  std::vector<std::string> places() const;

  const ViewSettings& s_;
  view::CameraControls& controls_;
  double tau_px_, geomorph_ms_;
  Budgets budgets_;
  DrawOptions draw_;
  std::unique_ptr<Renderer> renderer_;
  view::Scene scene_;
  std::optional<terrain_view::TerrainLook> look_;  ///< of the first file that is terrain
  std::optional<std::array<double, 2>> pointer_;   ///< pixels; none while it is elsewhere
  bool settled_ = false, frozen_ = false;
  double draw_ms_ = 0;
  UploadReport uploads_;
  std::optional<std::vector<FrameRecord>> recorded_;
};

/// The cache is shared by the files' sizes.
Result<void> SurfaceSubject::add_files(const std::vector<std::filesystem::path>& files) {
  std::vector<double> sizes;
  for (const auto& path : files) {
    std::error_code ignored;
    const auto size = std::filesystem::file_size(path, ignored);
    sizes.push_back(ignored ? 1.0 : 1.0 + static_cast<double>(size));
  }
  const auto shares = view::share_bytes(s_.cache_bytes, sizes);
  for (std::size_t i = 0; i < files.size(); ++i)
    if (auto r = add_file(files[i], shares[i]); !r) return r;
  if (!look_ && !files.empty() && (s_.shading == Shading::relief || s_.exaggeration != 1))
    return fail(ErrorCode::invalid_input, files.front().string(), "--shading, --exaggerate",
                "no file is terrain: there is no height in them; leave the option out");
  return {};
}

Result<void> SurfaceSubject::add_file(const std::filesystem::path& path, std::uint64_t cache_bytes) {
  auto cut = open_cut(path, cache_bytes, s_.load_threads);
  if (!cut) return fail(cut.error());
  auto look = terrain_view::terrain_look((*cut)->directory(), path);
  if (!look) return fail(look.error());
  (*cut)->set_visual_error({s_.visual_factor, {}});
  auto points = sketch_points(**cut);
  if (*look && !look_) take_look(std::move(**look));
  scene_.add(path.filename().string(), std::move(*cut), std::move(points));
  return {};
}

/// World units are metres from now on, and up is that of each place.
void SurfaceSubject::take_look(terrain_view::TerrainLook look) {
  look_.emplace(std::move(look));
  look_->relief.exaggeration = s_.exaggeration;
  terrain_view::set_look(*look_, draw_);
  draw_.shading = shading_of(s_.shading, look_);
}

/// The camera moves as fits what is there.
void SurfaceSubject::set_controls() {
  controls_.set_model_size(scene_.diagonal());
  if (look_) controls_.set_ground({.up = [this](Vec3d p) { return look_->relief.up(p); }});
}

/// What the others have been given stays theirs; a file that comes later may fill half as much as all of
/// them.
std::string SurfaceSubject::add(const std::filesystem::path& file) {
  const auto added = add_file(file, s_.cache_bytes / 2);
  set_controls();
  return added ? file.filename().string() + " opened" : added.error().text();
}

std::string SurfaceSubject::title() const {
  std::string names;
  for (const auto& object : scene_.objects()) names += (names.empty() ? "" : ", ") + object.name;
  return names;
}

Result<void> SurfaceSubject::draw_into(std::unique_ptr<GlContext> context) {
  auto renderer = Renderer::create(std::move(context));
  if (!renderer) return fail(renderer.error());
  renderer_ = std::move(*renderer);
  set_controls();
  return {};
}

View SurfaceSubject::first_view(const View& picture) const {
  if (s_.camera) return camera_view(*s_.camera, picture, s_.up_given, look_);
  if (look_ && !s_.up_given) return terrain_view::first_view(*look_, points(), picture);
  return fit_view(points(), three_quarter_direction(picture.up), picture);
}

SurfaceSubject::Taken SurfaceSubject::take(const WindowEvent& event) {
  if (event.kind == WindowEvent::Kind::leave) pointer_.reset();
  if (event.kind != WindowEvent::Kind::move) return Taken::no;
  pointer_ = {event.x, event.y};
  return look_ ? Taken::noticed : Taken::no;  // the statistics say what is under it
}

std::string SurfaceSubject::exaggerate(double factor) {
  if (!look_) return "no file is terrain";
  double& exaggeration = look_->relief.exaggeration;
  exaggeration = std::clamp(exaggeration * factor, least_exaggeration, largest_exaggeration);
  if (std::abs(exaggeration - 1) < 0.01) exaggeration = 1;
  terrain_view::set_look(*look_, draw_);
  return fmt::format("heights drawn {:.3g} times as high", exaggeration);
}

std::string SurfaceSubject::change_tau(double factor) {
  tau_px_ = std::clamp(tau_px_ * factor, least_tau_px, largest_tau_px);
  return fmt::format("tau {:.3g} px", tau_px_);
}

std::string SurfaceSubject::change_triangles(double factor) {
  const std::uint64_t now =
      budgets_.triangles == Budgets{}.triangles ? scene_.report().triangles : budgets_.triangles;
  const double wanted = static_cast<double>(now) * factor;
  budgets_.triangles = std::max(least_triangles, static_cast<std::uint64_t>(std::min(wanted, 1e15)));
  return fmt::format("at most {} triangles", with_commas(budgets_.triangles));
}

std::string SurfaceSubject::change_time(double factor) {
  budgets_.adapt_ms =
      std::isfinite(budgets_.adapt_ms) ? std::clamp(budgets_.adapt_ms * factor, 0.125, 1000.0) : 16;
  return fmt::format("at most {:.3g} ms of adapting a frame", budgets_.adapt_ms);
}

std::string SurfaceSubject::toggle_geomorphs() {
  geomorph_ms_ = geomorph_ms_ > 0 ? 0 : s_.geomorph_ms > 0 ? s_.geomorph_ms : usual_geomorph_ms;
  return geomorph_ms_ > 0 ? fmt::format("blends of {:g} ms", geomorph_ms_) : "no blends";
}

void SurfaceSubject::freeze() {
  frozen_ = !frozen_;
  if (frozen_) scene_.list_all();
}

/// Again: the usual one.
void SurfaceSubject::shade(Shading shading) {
  draw_.shading = draw_.shading == shading ? shading_of({}, look_) : shading;
}

std::string SurfaceSubject::act(Action action) {
  switch (action) {
    case Action::tau_finer:
      return change_tau(1 / budget_factor);
    case Action::tau_coarser:
      return change_tau(budget_factor);
    case Action::fewer_triangles:
      return change_triangles(1 / budget_factor);
    case Action::more_triangles:
      return change_triangles(budget_factor);
    case Action::less_time:
      return change_time(1 / budget_factor);
    case Action::more_time:
      return change_time(budget_factor);
    case Action::flatter:
      return exaggerate(1 / exaggeration_factor);
    case Action::steeper:
      return exaggerate(exaggeration_factor);
    case Action::geomorph:
      return toggle_geomorphs();
    case Action::freeze:
      freeze();
      return {};
    case Action::lit:
      draw_.shading = Shading::lit;
      return {};
    case Action::wireframe:
      shade(Shading::wireframe);
      return {};
    case Action::normals:
      shade(Shading::normals);
      return {};
    case Action::changes:
      shade(Shading::changes);
      return {};
    case Action::pages:
      shade(Shading::pages);
      return {};
    case Action::relief:
      if (!look_) return "no file is terrain";
      draw_.shading = Shading::relief;
      return {};
    case Action::page_borders:
      draw_.page_borders = !draw_.page_borders;
      return {};
    default:
      return "only scenes have that";
  }
}

/// @return true if what is drawn has changed.
bool SurfaceSubject::adapt(const ViewMoment& moment) {
  // Someone who walks or flies does not see the ground below, but stays above it.
  const bool by_ground =
      controls_.mode() == ControlMode::walk || (look_ && controls_.mode() == ControlMode::fly);
  const bool changed = scene_.adapt(controls_.view(), {.tau_px = tau_px_,
                                                       .outside_factor = s_.outside_factor,
                                                       .budgets = budgets_,
                                                       .geomorph_ms = geomorph_ms_,
                                                       .only_visible = !by_ground,
                                                       .tags = draw_.shading == Shading::changes,
                                                       .relief = draw_.relief});
  if (changed && look_ && !moment.in_flight) controls_.surface_changed();
  settled_ = scene_.report().settled && scene_.report().morphing == 0;
  return changed;
}

Result<void> SurfaceSubject::draw(double now_s) {
  const double start = clock_ms();
  if (auto r = renderer_->draw(scene_.lists(), controls_.view(), draw_); !r) return r;
  scene_.mark_drawn();
  uploads_ = renderer_->uploads();
  draw_ms_ = clock_ms() - start;
  if (recorded_) recorded_->push_back({now_s, scene_.report(), draw_ms_});
  return {};
}

Result<ViewedFrame> SurfaceSubject::frame(const ViewMoment& moment) {
  const bool changed = !frozen_ && adapt(moment);
  const bool settled = settled_ || frozen_;
  ViewedFrame made{moment.must_draw || changed || (settled && !moment.was_at_rest), settled};
  if (made.drawn)
    if (auto r = draw(moment.now_s); !r) return fail(r.error());
  return made;
}

std::vector<std::string> SurfaceSubject::statistics(const ViewTimes& times) const {
  view::FrameStatistics f;
  f.title = title();
  f.driver = renderer_->driver();
  f.mode = controls_.mode();
  f.speed = controls_.speed();
  f.frame_ms = times.frame_ms;
  f.draw_ms = draw_ms_ + times.show_ms;
  f.adapt = scene_.report();
  f.adapt.settled = settled_;
  f.bound_by = name(f.adapt.bound_by);
  f.tau_px = tau_px_;
  f.budgets = budgets_;
  f.pages = scene_.resident_pages();
  f.cache_bytes = scene_.cache_bytes();
  f.upload_bytes = uploads_.bytes;
  f.upload_calls = uploads_.calls;
  f.unreadable_pages = scene_.unreadable_pages();
  f.frozen = frozen_;
  f.places = places();
  return view::statistics_lines(f);
}

std::vector<std::string> SurfaceSubject::places() const {
  if (!look_) return {};
  const View& view = controls_.view();
  const auto at = pointer_.value_or(std::array{view.width_px / 2.0, view.height_px / 2.0});
  const auto under = hit(view.eye, view::ray_direction(view, at[0], at[1]));
  const auto height = controls_.height_above_ground();
  std::vector<std::string> lines{"camera     " + terrain_view::place_text(*look_, view.eye)};
  if (height) lines.push_back(fmt::format("           {:.1f} m above ground", *height));
  lines.push_back(
      (pointer_ ? "pointer    " : "centre     ") +
      (under ? terrain_view::place_text(*look_, look_->relief.lowered(*under)) : std::string("-")));
  if (look_->relief.exaggeration != 1)
    lines.push_back(fmt::format("heights    drawn {:.3g} times as high", look_->relief.exaggeration));
  return lines;
}

std::string SurfaceSubject::take_frames_csv() {
  return frames_csv(std::exchange(recorded_, std::nullopt).value_or(std::vector<FrameRecord>{}));
}

std::vector<Error> SurfaceSubject::errors() const {
  std::vector<Error> all;
  for (const auto& object : scene_.objects())
    for (const Error& error : object.cut->cache().errors()) all.push_back(error);
  return all;
}

}  // namespace

Result<std::unique_ptr<ViewSubject>> open_surface_subject(const ViewSettings& settings,
                                                          const std::vector<std::filesystem::path>& files,
                                                          view::CameraControls& controls) {
  auto subject = std::make_unique<SurfaceSubject>(settings, controls);
  if (auto r = subject->add_files(files); !r) return fail(r.error());
  return subject;
}

}  // namespace cuesta::app
