#include "apps/cuesta/view_command.h"

#include <fmt/format.h>

#include <cmath>
#include <deque>
#include <sstream>

#include "apps/cuesta/machine.h"
#include "apps/cuesta/open_cut.h"
#include "apps/cuesta/stop_signal.h"
#include "apps/cuesta/terrain_settings.h"
#include "apps/overview/sketch.h"
#include "apps/view/budget_shares.h"
#include "apps/view/camera_controls.h"
#include "apps/view/flight_recorder.h"
#include "apps/view/scene.h"
#include "apps/view/statistics_text.h"
#include "apps/view/view_keys.h"
#include "runtime/draw/png_file.h"
#include "runtime/draw/window.h"
#include "runtime/flight_file.h"
#include "runtime/view_fit.h"

namespace cuesta::app {
namespace {

using view::Action;
using view::ControlMode;

constexpr double idle_wait_s = 0.25;     // between looks at a stop that was asked for
constexpr double least_frame_s = 0.004;  // where the driver does not wait for the screen
constexpr double longest_step_s = 0.1;   // that held keys move for: a hitch is no leap
constexpr double message_s = 5;
constexpr double usual_geomorph_ms = 250;
constexpr double budget_factor = 1.4142135623730951;
constexpr std::uint64_t least_triangles = 1000;
constexpr double least_tau_px = 1.0 / 64, largest_tau_px = 64;
constexpr double exaggeration_factor = 1.25, least_exaggeration = 0.1, largest_exaggeration = 50;

double now_s() {
  return clock_ms() / 1000;
}

/// The first of name-001.ext, name-002.ext … in this folder that is not there yet.
std::filesystem::path free_name(const std::string& stem, const char* extension) {
  for (int n = 1;; ++n) {
    const std::filesystem::path path = fmt::format("{}-{:03}{}", stem, n, extension);
    std::error_code ignored;
    if (!std::filesystem::exists(path, ignored)) return path;
  }
}

class Viewer {
 public:
  static Result<std::unique_ptr<Viewer>> open(const ViewSettings& settings);
  Result<void> run();

 private:
  explicit Viewer(const ViewSettings& settings)
      : s_(settings),
        tau_px_(settings.tau_px),
        geomorph_ms_(settings.geomorph_ms),
        budgets_(settings.budgets),
        draw_(settings.draw),
        controls_([this](Vec3d origin, Vec3d direction) { return scene_.hit(origin, direction); }) {}

  Result<void> add_file(const std::filesystem::path& path, std::uint64_t cache_bytes);
  Result<void> add_files();
  void take_look(terrain_view::TerrainLook look);
  void drop(const std::vector<std::filesystem::path>& paths);
  void fit();

  void take_events();
  void take(const WindowEvent& event);
  void act(Action action);
  void act_on_look(Action action);
  void act_on_budgets(Action action);
  void exaggerate(double factor);
  void leave();
  void toggle_recording();
  void toggle_flight();
  void save_picture(const std::filesystem::path& path);
  void say(std::string text);

  bool move_camera(double seconds);
  Result<void> frame();
  Result<void> draw();
  std::vector<TextBlock> texts() const;
  std::vector<std::string> statistics() const;
  std::vector<std::string> places() const;
  bool at_rest() const;
  Result<void> follow_script();
  std::string stem() const;

  const ViewSettings& s_;
  double tau_px_, geomorph_ms_;
  Budgets budgets_;
  DrawOptions draw_;
  std::unique_ptr<Window> window_;  // outlives the renderer
  std::unique_ptr<Renderer> renderer_;
  view::Scene scene_;
  view::CameraControls controls_;
  view::FlightRecorder recorder_;
  std::optional<Flight> flight_;
  std::optional<double> flight_start_s_;  ///< while the flight is played

  std::optional<terrain_view::TerrainLook> look_;  ///< of the first file that is terrain
  std::optional<std::array<double, 2>> pointer_;   ///< pixels; none while it is elsewhere

  bool placed_ = false;  ///< the camera shows the model
  bool open_ = true, redraw_ = true, settled_ = false, frozen_ = false;
  bool help_ = false, statistics_ = true;
  std::string message_;
  double message_end_s_ = 0;
  double last_frame_s_ = 0, frame_ms_ = 0, draw_ms_ = 0;
  bool was_at_rest_ = true;
  UploadReport uploads_;

  std::deque<Key> presses_;  ///< of the script, still to come
  bool scripted_flight_ = false, picture_due_ = false;
};

Result<std::unique_ptr<Viewer>> Viewer::open(const ViewSettings& s) {
  std::unique_ptr<Viewer> v(new Viewer(s));
  std::istringstream names(s.press);
  for (std::string name; names >> name;) {
    v->presses_.push_back(view::key_named(name));
    if (v->presses_.back() == Key::unknown)
      return fail(ErrorCode::invalid_input, "", "--press", "there is no key \"" + name + "\"");
  }
  if (!s.flight.empty()) {
    auto flight = read_flight(s.flight);
    if (!flight) return fail(flight.error());
    v->flight_ = std::move(*flight);
    v->scripted_flight_ = true;
  }
  v->picture_due_ = !s.screenshot.empty();
  v->controls_.set_view(s.view);
  if (auto r = v->add_files(); !r) return fail(r.error());
  if (!v->look_ && !s.files.empty() && (s.shading == Shading::relief || s.exaggeration != 1))
    return fail(ErrorCode::invalid_input, s.files.front().string(), "--shading, --exaggerate",
                "no file is terrain: there is no height in them; leave the option out");
  auto window = Window::open(s.files.empty() ? "Cuesta" : s.files.front().filename().string() + " - Cuesta",
                             s.view.width_px, s.view.height_px);
  if (!window) return fail(window.error());
  v->window_ = std::move(*window);
  auto renderer = Renderer::create(v->window_->context());
  if (!renderer) return fail(renderer.error());
  v->renderer_ = std::move(*renderer);
  if (s.full_screen) v->window_->set_full_screen(true);
  v->fit();
  return v;
}

Result<void> Viewer::add_file(const std::filesystem::path& path, std::uint64_t cache_bytes) {
  auto cut = open_cut(path, cache_bytes, s_.load_threads);
  if (!cut) return fail(cut.error());
  auto look = terrain_view::terrain_look((*cut)->directory(), path);
  if (!look) return fail(look.error());
  (*cut)->set_visual_error({s_.visual_factor, {}});
  auto points = sketch_points(**cut);
  if (*look && !look_) take_look(std::move(**look));
  scene_.add(path.filename().string(), std::move(*cut), std::move(points));
  controls_.set_model_size(scene_.diagonal());
  settled_ = false;
  return {};
}

/// World units are metres from now on, and up is that of each place.
void Viewer::take_look(terrain_view::TerrainLook look) {
  look_.emplace(std::move(look));
  look_->relief.exaggeration = s_.exaggeration;
  terrain_view::set_look(*look_, draw_);
  draw_.shading = shading_of(s_.shading, look_);
  controls_.set_ground({.up = [this](Vec3d p) { return look_->relief.up(p); }});
}

void Viewer::exaggerate(double factor) {
  if (!look_) return say("no file is terrain");
  double& exaggeration = look_->relief.exaggeration;
  exaggeration = std::clamp(exaggeration * factor, least_exaggeration, largest_exaggeration);
  if (std::abs(exaggeration - 1) < 0.01) exaggeration = 1;
  terrain_view::set_look(*look_, draw_);
  say(fmt::format("heights drawn {:.3g} times as high", exaggeration));
  settled_ = false;
}

/// The cache is shared by the files' sizes.
Result<void> Viewer::add_files() {
  std::vector<double> sizes;
  for (const auto& path : s_.files) {
    std::error_code ignored;
    const auto size = std::filesystem::file_size(path, ignored);
    sizes.push_back(ignored ? 1.0 : 1.0 + static_cast<double>(size));
  }
  const auto shares = view::share_bytes(s_.cache_bytes, sizes);
  for (std::size_t i = 0; i < s_.files.size(); ++i)
    if (auto r = add_file(s_.files[i], shares[i]); !r) return r;
  return {};
}

/// What the others have been given stays theirs; a file that comes later may fill half as much as all of
/// them.
void Viewer::drop(const std::vector<std::filesystem::path>& paths) {
  const bool first = scene_.objects().empty();
  for (const auto& path : paths) {
    const auto added = add_file(path, first ? s_.cache_bytes : s_.cache_bytes / 2);
    say(added ? path.filename().string() + " opened" : added.error().text());
  }
  if (first) fit();
}

void Viewer::fit() {
  const auto [width, height] = window_->size_px();
  controls_.set_picture_size(std::max(width, 1), std::max(height, 1));
  View view = controls_.view();
  const auto points = scene_.points();
  if (points.empty()) return;
  if (!placed_ && s_.camera)
    view = camera_view(*s_.camera, view, s_.up_given, look_);
  else if (!placed_ && look_ && !s_.up_given)
    view = terrain_view::first_view(*look_, points, view);
  else
    view = fit_view(points, placed_ ? view.eye - view.target : three_quarter_direction(view.up), view);
  controls_.set_view(view);
  placed_ = redraw_ = true;
}

std::string Viewer::stem() const {
  return scene_.objects().empty() ? "cuesta"
                                  : std::filesystem::path(scene_.objects()[0].name).stem().string();
}

void Viewer::say(std::string text) {
  message_ = std::move(text);
  message_end_s_ = now_s() + message_s;
  redraw_ = true;
}

bool Viewer::at_rest() const {
  return settled_ && !redraw_ && !controls_.moving() && !flight_start_s_ && presses_.empty() &&
         !scripted_flight_ && !picture_due_ && !s_.exit;
}

void Viewer::take_events() {
  double wait_s = 0;
  if (at_rest()) {
    wait_s = idle_wait_s;
  } else if (!was_at_rest_) {
    wait_s = std::max(0.0, last_frame_s_ + least_frame_s - now_s());
  }
  if (!message_.empty() && now_s() > message_end_s_) {
    message_.clear();
    redraw_ = true;
  }
  const bool dragging = controls_.dragging();
  for (const WindowEvent& event : window_->events(wait_s)) take(event);
  if (controls_.dragging() != dragging) window_->hold_pointer(controls_.dragging());
}

void Viewer::take(const WindowEvent& event) {
  using Kind = WindowEvent::Kind;
  if (event.kind == Kind::close) open_ = false;
  if (event.kind == Kind::redraw) redraw_ = true;
  if (event.kind == Kind::drop) drop(event.paths);
  if (event.kind == Kind::move) pointer_ = {event.x, event.y};
  if (event.kind == Kind::leave) pointer_.reset();
  const Action action = view::action_of(event);
  if (action != Action::none) {
    act(action);
    redraw_ = true;
    return;
  }
  const bool pointer_only = event.kind == Kind::move && !controls_.dragging();
  if (pointer_only && look_ && statistics_) redraw_ = true;  // they say what is under it
  if (controls_.handle(event) && !pointer_only) {
    if (event.kind == Kind::move || event.kind == Kind::scroll || event.kind == Kind::key_down)
      flight_start_s_.reset();
    redraw_ = true;
  }
}

void Viewer::act_on_look(Action action) {
  const auto shade = [&](Shading shading) {
    draw_.shading = draw_.shading == shading ? shading_of({}, look_) : shading;
  };
  if (action == Action::lit) draw_.shading = Shading::lit;
  if (action == Action::wireframe) shade(Shading::wireframe);
  if (action == Action::normals) shade(Shading::normals);
  if (action == Action::changes) shade(Shading::changes);
  if (action == Action::pages) shade(Shading::pages);
  if (action == Action::relief && look_) draw_.shading = Shading::relief;
  if (action == Action::relief && !look_) say("no file is terrain");
  if (action == Action::flatter) exaggerate(1 / exaggeration_factor);
  if (action == Action::steeper) exaggerate(exaggeration_factor);
  if (action == Action::page_borders) draw_.page_borders = !draw_.page_borders;
}

void Viewer::act_on_budgets(Action action) {
  const auto triangles = [&](double factor) {
    const std::uint64_t now =
        budgets_.triangles == Budgets{}.triangles ? scene_.report().triangles : budgets_.triangles;
    const double wanted = static_cast<double>(now) * factor;
    budgets_.triangles = std::max(least_triangles, static_cast<std::uint64_t>(std::min(wanted, 1e15)));
    say(fmt::format("at most {} triangles", with_commas(budgets_.triangles)));
  };
  const auto tau = [&](double factor) {
    tau_px_ = std::clamp(tau_px_ * factor, least_tau_px, largest_tau_px);
    say(fmt::format("tau {:.3g} px", tau_px_));
  };
  const auto time = [&](double factor) {
    budgets_.adapt_ms =
        std::isfinite(budgets_.adapt_ms) ? std::clamp(budgets_.adapt_ms * factor, 0.125, 1000.0) : 16;
    say(fmt::format("at most {:.3g} ms of adapting a frame", budgets_.adapt_ms));
  };
  if (action == Action::fewer_triangles) triangles(1 / budget_factor);
  if (action == Action::more_triangles) triangles(budget_factor);
  if (action == Action::tau_finer) tau(1 / budget_factor);
  if (action == Action::tau_coarser) tau(budget_factor);
  if (action == Action::less_time) time(1 / budget_factor);
  if (action == Action::more_time) time(budget_factor);
  settled_ = false;
}

void Viewer::leave() {
  if (help_)
    help_ = false;
  else if (flight_start_s_)
    flight_start_s_.reset();
  else
    window_->set_full_screen(false);
}

void Viewer::toggle_recording() {
  if (!recorder_.recording()) {
    recorder_.start(now_s());
    say("recording a flight; R saves it");
    return;
  }
  recorder_.add(now_s(), controls_.view());
  auto flight = recorder_.finish();
  if (!flight) return;
  const auto path = free_name(stem() + "-flight", ".json");
  const auto written = write_flight(path, *flight);
  say(written ? path.string() + " saved; space plays it" : written.error().text());
  fmt::print("{}\n", message_);
  flight_ = std::move(flight);
}

void Viewer::toggle_flight() {
  if (flight_start_s_) {
    flight_start_s_.reset();
  } else if (flight_) {
    flight_start_s_ = now_s();
  } else {
    say("there is no flight yet: R records one");
  }
}

void Viewer::save_picture(const std::filesystem::path& path) {
  const auto picture = renderer_->read();
  const auto written = picture ? write_png(path, *picture) : Result<void>(fail(picture.error()));
  say(written ? path.string() + " saved" : written.error().text());
  fmt::print("{}\n", message_);
}

void Viewer::act(Action action) {
  switch (action) {
    case Action::help:
      help_ = !help_;
      return;
    case Action::statistics:
      statistics_ = !statistics_;
      return;
    case Action::orbit:
      return controls_.set_mode(ControlMode::orbit);
    case Action::fly:
      return controls_.set_mode(ControlMode::fly);
    case Action::walk:
      return controls_.set_mode(ControlMode::walk);
    case Action::fit:
      return fit();
    case Action::screenshot:
      return save_picture(free_name(stem() + "-view", ".png"));
    case Action::record:
      return toggle_recording();
    case Action::play:
      return toggle_flight();
    case Action::geomorph:
      geomorph_ms_ = geomorph_ms_ > 0 ? 0 : s_.geomorph_ms > 0 ? s_.geomorph_ms : usual_geomorph_ms;
      return say(geomorph_ms_ > 0 ? fmt::format("blends of {:g} ms", geomorph_ms_) : "no blends");
    case Action::freeze:
      frozen_ = !frozen_;
      if (frozen_) scene_.list_all();
      return;
    case Action::full_screen:
      return window_->set_full_screen(!window_->full_screen());
    case Action::leave:
      return leave();
    case Action::quit:
      open_ = false;
      return;
    default:
      act_on_look(action);
      if (action >= Action::tau_finer && action <= Action::more_time) act_on_budgets(action);
  }
}

/// @return true if the camera is another one than in the last frame.
bool Viewer::move_camera(double seconds) {
  const View before = controls_.view();
  const auto [width, height] = window_->size_px();
  controls_.set_picture_size(std::max(width, 1), std::max(height, 1));
  if (flight_start_s_) {
    const double length_s = flight_->keyframes.back().time_s - flight_->keyframes.front().time_s;
    const double at_s = std::min(now_s() - *flight_start_s_, length_s);
    controls_.set_view(flight_view(*flight_, at_s, controls_.view()));
    if (at_s >= length_s) flight_start_s_.reset();
  } else {
    controls_.advance(seconds);
  }
  const View& now = controls_.view();
  return before.eye != now.eye || before.target != now.target || before.width_px != now.width_px ||
         before.height_px != now.height_px;
}

std::vector<std::string> Viewer::statistics() const {
  view::FrameStatistics f;
  for (const auto& object : scene_.objects()) f.title += (f.title.empty() ? "" : ", ") + object.name;
  f.driver = renderer_->driver();
  f.mode = controls_.mode();
  f.speed = controls_.speed();
  f.frame_ms = frame_ms_;
  f.draw_ms = draw_ms_;
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

std::vector<std::string> Viewer::places() const {
  if (!look_) return {};
  const View& view = controls_.view();
  const auto at = pointer_.value_or(std::array{view.width_px / 2.0, view.height_px / 2.0});
  const auto under = scene_.hit(view.eye, view::ray_direction(view, at[0], at[1]));
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

std::vector<TextBlock> Viewer::texts() const {
  std::vector<TextBlock> blocks;
  if (scene_.objects().empty())
    blocks.push_back({TextPlace::centre, {"Drop .cuesta files here.", "F1 shows what the keys do."}});
  else if (statistics_ && !help_)
    blocks.push_back({TextPlace::top_left, statistics()});
  if (recorder_.recording())
    blocks.push_back({TextPlace::top_right, {fmt::format("REC {:.1f} s", recorder_.seconds())}});
  if (!message_.empty()) blocks.push_back({TextPlace::bottom_left, {message_}});
  if (help_) blocks.push_back({TextPlace::centre, view::help_lines()});
  return blocks;
}

Result<void> Viewer::draw() {
  const auto [width, height] = window_->size_px();
  if (width == 0 || height == 0) return {};  // an icon
  const double start = clock_ms();
  if (auto r = renderer_->draw(scene_.lists(), controls_.view(), draw_); !r) return r;
  scene_.mark_drawn();
  uploads_ = renderer_->uploads();
  const int text_scale =
      std::max(1, static_cast<int>(std::lround(window_->content_scale() * (height < 500 ? 1 : 2))));
  if (auto r = renderer_->show(width, height, texts(), text_scale); !r) return r;
  draw_ms_ = clock_ms() - start;
  window_->show();
  return {};
}

Result<void> Viewer::frame() {
  const double start_s = now_s();
  const double since_s = start_s - last_frame_s_;
  const bool moved = move_camera(was_at_rest_ ? least_frame_s : std::min(since_s, longest_step_s));
  recorder_.add(start_s, controls_.view());
  bool changed = false;
  if (!frozen_) {
    // Someone who walks or flies does not see the ground below, but stays above it.
    const bool by_ground =
        controls_.mode() == ControlMode::walk || (look_ && controls_.mode() == ControlMode::fly);
    const bool only_visible = !by_ground;
    changed = scene_.adapt(controls_.view(), {.tau_px = tau_px_,
                                              .outside_factor = s_.outside_factor,
                                              .budgets = budgets_,
                                              .geomorph_ms = geomorph_ms_,
                                              .only_visible = only_visible,
                                              .tags = draw_.shading == Shading::changes,
                                              .relief = draw_.relief});
    if (changed && look_ && !flight_start_s_) controls_.surface_changed();
    settled_ = scene_.report().settled && scene_.report().morphing == 0 && !moved && !controls_.moving();
  } else {
    settled_ = true;
  }
  if (!was_at_rest_) frame_ms_ = frame_ms_ == 0 ? since_s * 1000 : frame_ms_ * 0.9 + since_s * 100;
  last_frame_s_ = start_s;
  const bool due = redraw_ || moved || changed || (settled_ && !was_at_rest_);
  redraw_ = false;
  return due ? draw() : Result<void>{};
}

/// Keys, then the flight, then the picture once all has settled, then the end.
Result<void> Viewer::follow_script() {
  if (!presses_.empty()) {
    WindowEvent event;
    event.key = presses_.front();
    presses_.pop_front();
    event.kind = WindowEvent::Kind::key_down;
    take(event);
    event.kind = WindowEvent::Kind::key_up;
    take(event);
    return {};
  }
  if (scripted_flight_) {
    scripted_flight_ = false;
    flight_start_s_ = now_s();
    return {};
  }
  if (flight_start_s_ || !settled_ || redraw_) return {};
  if (picture_due_) {
    picture_due_ = false;
    const auto picture = renderer_->read();
    if (!picture) return fail(picture.error());
    if (auto r = write_png(s_.screenshot, *picture); !r) return r;
    say(s_.screenshot.string() + " saved");
  }
  if (s_.exit) open_ = false;
  return {};
}

Result<void> Viewer::run() {
  Result<void> done;
  while (open_ && done) {
    take_events();
    if (!open_ || stop_requested()) break;
    const bool idle = at_rest();
    if (!idle) done = frame();
    if (done && !idle) done = follow_script();
    was_at_rest_ = idle;
  }
  if (recorder_.recording()) toggle_recording();
  for (const auto& object : scene_.objects())
    for (const Error& error : object.cut->cache().errors())
      fmt::print(stderr, "cuesta: drawn coarser: {}\n", error.text());
  return done;
}

}  // namespace

Result<void> run_view(const ViewSettings& settings) {
  auto viewer = Viewer::open(settings);
  if (!viewer) return fail(viewer.error());
  return (*viewer)->run();
}

}  // namespace cuesta::app
