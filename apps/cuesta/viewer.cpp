#include "apps/cuesta/viewer.h"

#include <fmt/format.h>

#include <cmath>

#include "apps/cuesta/frame_table.h"
#include "apps/cuesta/machine.h"
#include "apps/cuesta/stop_signal.h"
#include "runtime/draw/png_file.h"
#include "runtime/flight_file.h"
#include "runtime/view_fit.h"

namespace cuesta::app {
namespace {

using view::Action;
using view::ControlMode;
using view::ScriptStep;

constexpr double idle_wait_s = 0.25;     // between looks at a stop that was asked for
constexpr double least_frame_s = 0.004;  // where the driver does not wait for the screen
constexpr double longest_step_s = 0.1;   // that held keys move for: a hitch is no leap
constexpr double message_s = 5;

double now_s() {
  return clock_ms() / 1000;
}

}  // namespace

Viewer::Viewer(const ViewSettings& settings)
    : s_(settings),
      first_file_(settings.files.empty() ? "cuesta" : settings.files.front()),
      controls_([this](Vec3d origin, Vec3d direction) { return subject_->hit(origin, direction); }) {}

Result<std::unique_ptr<Viewer>> Viewer::open(const ViewSettings& s) {
  std::unique_ptr<Viewer> v(new Viewer(s));
  auto script = view::ViewScript::of({s.press, !s.flight.empty(), !s.screenshot.empty(), s.exit});
  if (!script) return fail(script.error());
  v->script_ = std::move(*script);
  if (!s.flight.empty()) {
    auto flight = read_flight(s.flight);
    if (!flight) return fail(flight.error());
    v->flight_.set(std::move(*flight));
  }
  v->controls_.set_view(s.view);
  auto subject = open_subject(s, s.files, v->controls_);
  if (!subject) return fail(subject.error());
  v->subject_ = std::move(*subject);
  if (auto r = v->open_window(); !r) return fail(r.error());
  v->fit();
  return v;
}

Result<void> Viewer::open_window() {
  auto window = Window::open(s_.files.empty() ? "Cuesta" : first_file_.filename().string() + " - Cuesta",
                             s_.view.width_px, s_.view.height_px);
  if (!window) return fail(window.error());
  window_ = std::move(*window);
  if (auto r = subject_->draw_into(window_->context()); !r) return r;
  if (s_.full_screen) window_->set_full_screen(true);
  return {};
}

/// What the first files are decides what else can come.
Result<void> Viewer::begin_with(const std::vector<std::filesystem::path>& paths) {
  auto subject = open_subject(s_, paths, controls_);
  if (!subject) return fail(subject.error());
  if (auto r = (*subject)->draw_into(window_->context()); !r) return r;
  subject_ = std::move(*subject);
  first_file_ = paths.front();
  window_->set_title(first_file_.filename().string() + " - Cuesta");
  fit();
  return {};
}

void Viewer::drop(const std::vector<std::filesystem::path>& paths) {
  settled_ = false;
  if (subject_->is_empty() && !paths.empty()) {
    const auto begun = begin_with(paths);
    return say(begun ? subject_->title() + " opened" : begun.error().text());
  }
  for (const auto& path : paths) say(subject_->add(path));
}

void Viewer::fit() {
  const auto [width, height] = window_->size_px();
  controls_.set_picture_size(std::max(width, 1), std::max(height, 1));
  const View view = controls_.view();
  const auto points = subject_->points();
  if (points.empty()) return;
  controls_.set_view(placed_ ? fit_view(points, view.eye - view.target, view) : subject_->first_view(view));
  placed_ = redraw_ = true;
}

/// The first of FILE-what-001.ext, FILE-what-002.ext … in this folder that is not there yet.
std::filesystem::path Viewer::free_name(const char* what, const char* extension) const {
  for (int n = 1;; ++n) {
    const std::filesystem::path path =
        fmt::format("{}-{}-{:03}{}", first_file_.stem().string(), what, n, extension);
    std::error_code ignored;
    if (!std::filesystem::exists(path, ignored)) return path;
  }
}

void Viewer::say(std::string text) {
  if (text.empty()) return;
  message_ = std::move(text);
  message_end_s_ = now_s() + message_s;
  redraw_ = true;
}

bool Viewer::at_rest() const {
  return settled_ && !redraw_ && !controls_.moving() && !flight_.playing() && !script_.busy();
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
  const Action action = view::action_of(event);
  if (action != Action::none) {
    act(action);
    redraw_ = true;
    return;
  }
  const auto taken = controls_.dragging() ? ViewSubject::Taken::no : subject_->take(event);
  const bool whole = taken == ViewSubject::Taken::whole;
  if (whole || (taken == ViewSubject::Taken::noticed && statistics_)) redraw_ = true;
  if (whole) return;
  const bool pointer_only = event.kind == Kind::move && !controls_.dragging();
  if (controls_.handle(event) && !pointer_only) {
    if (event.kind == Kind::move || event.kind == Kind::scroll || event.kind == Kind::key_down)
      flight_.stop();
    redraw_ = true;
  }
}

void Viewer::leave() {
  if (help_)
    help_ = false;
  else if (flight_.playing())
    flight_.stop();
  else
    window_->set_full_screen(false);
}

void Viewer::toggle_recording() {
  if (recorder_.recording()) return save_recording();
  recorder_.start(now_s());
  subject_->record_frames();
  say("recording a flight; R saves it");
}

/// The flight, and what its frames were like.
void Viewer::save_recording() {
  recorder_.add(now_s(), controls_.view());
  auto flight = recorder_.finish();
  if (!flight) return;
  auto path = free_name("flight", ".json");
  auto written = write_flight(path, *flight);
  const std::string saved = path.string();
  if (written) written = write_text(path.replace_extension(".csv"), subject_->take_frames_csv());
  say(written ? saved + " saved; space plays it" : written.error().text());
  fmt::print("{}\n", message_);
  flight_.set(std::move(*flight));
}

void Viewer::toggle_flight() {
  if (flight_.playing())
    flight_.stop();
  else if (flight_.has_flight())
    flight_.start(now_s());
  else
    say("there is no flight yet: R records one");
}

Result<void> Viewer::write_picture(const std::filesystem::path& path) {
  const auto picture = subject_->read();
  if (!picture) return fail(picture.error());
  if (auto r = write_png(path, *picture); !r) return r;
  say(path.string() + " saved");
  return {};
}

void Viewer::save_picture() {
  if (const auto written = write_picture(free_name("view", ".png")); !written) say(written.error().text());
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
      return save_picture();
    case Action::record:
      return toggle_recording();
    case Action::play:
      return toggle_flight();
    case Action::full_screen:
      return window_->set_full_screen(!window_->full_screen());
    case Action::leave:
      return leave();
    case Action::quit:
      open_ = false;
      return;
    default:
      settled_ = false;
      say(subject_->act(action));
  }
}

/// @return true if the camera is another one than in the last frame.
bool Viewer::move_camera(double seconds) {
  const View before = controls_.view();
  const auto [width, height] = window_->size_px();
  controls_.set_picture_size(std::max(width, 1), std::max(height, 1));
  if (flight_.playing())
    controls_.set_view(flight_.view(now_s(), controls_.view()));
  else
    controls_.advance(seconds);
  const View& now = controls_.view();
  return before.eye != now.eye || before.target != now.target || before.width_px != now.width_px ||
         before.height_px != now.height_px;
}

std::vector<TextBlock> Viewer::texts() const {
  std::vector<TextBlock> blocks;
  if (subject_->is_empty())
    blocks.push_back({TextPlace::centre, {"Drop .cuesta files here.", "F1 shows what the keys do."}});
  else if (statistics_ && !help_)
    blocks.push_back({TextPlace::top_left, subject_->statistics(times_)});
  if (recorder_.recording())
    blocks.push_back({TextPlace::top_right, {fmt::format("REC {:.1f} s", recorder_.seconds())}});
  if (!message_.empty()) blocks.push_back({TextPlace::bottom_left, {message_}});
  if (help_) blocks.push_back({TextPlace::centre, view::help_lines()});
  return blocks;
}

Result<void> Viewer::show() {
  const auto [width, height] = window_->size_px();
  const double start = clock_ms();
  const int text_scale =
      std::max(1, static_cast<int>(std::lround(window_->content_scale() * (height < 500 ? 1 : 2))));
  if (auto r = subject_->show(width, height, texts(), text_scale); !r) return r;
  times_.show_ms = clock_ms() - start;
  window_->show();
  return {};
}

Result<void> Viewer::frame() {
  const double start_s = now_s();
  const double since_s = start_s - last_frame_s_;
  const bool moved = move_camera(was_at_rest_ ? least_frame_s : std::min(since_s, longest_step_s));
  recorder_.add(start_s, controls_.view());
  if (!was_at_rest_)
    times_.frame_ms = times_.frame_ms == 0 ? since_s * 1000 : times_.frame_ms * 0.9 + since_s * 100;
  last_frame_s_ = start_s;
  if (window_->size_px()[0] == 0 || window_->size_px()[1] == 0) return {};  // an icon
  const auto made =
      subject_->frame({start_s, std::exchange(redraw_, false) || moved, was_at_rest_, flight_.playing()});
  if (!made) return fail(made.error());
  settled_ = made->settled && !moved && !controls_.moving();
  return made->drawn ? show() : Result<void>{};
}

Result<void> Viewer::follow_script() {
  switch (script_.next(settled_ && !flight_.playing() && !redraw_)) {
    case ScriptStep::press: {
      WindowEvent event;
      event.key = script_.key();
      event.kind = WindowEvent::Kind::key_down;
      take(event);
      event.kind = WindowEvent::Kind::key_up;
      take(event);
      break;
    }
    case ScriptStep::fly:
      flight_.start(now_s());
      break;
    case ScriptStep::picture:
      return write_picture(s_.screenshot);
    case ScriptStep::close:
      open_ = false;
      break;
    case ScriptStep::none:
      break;
  }
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
  if (recorder_.recording()) save_recording();
  for (const Error& error : subject_->errors())
    fmt::print(stderr, "cuesta: drawn coarser: {}\n", error.text());
  return done;
}

}  // namespace cuesta::app
