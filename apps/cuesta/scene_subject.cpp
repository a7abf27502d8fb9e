/// A scene in a viewer: frames within a deadline, clips, parts that can be moved.

#include <fmt/format.h>

#include <cmath>
#include <utility>

#include "apps/cuesta/machine.h"
#include "apps/cuesta/scene_settings.h"
#include "apps/cuesta/terrain_settings.h"
#include "apps/cuesta/view_subject.h"
#include "apps/scene_show/part_ray.h"
#include "apps/scene_show/scene_frames.h"
#include "apps/scene_show/scene_statistics.h"
#include "runtime/view_fit.h"

namespace cuesta::app {
namespace {

using scene_show::PlayedFrame;
using scene_show::ScenePlayer;
using view::Action;
using view::ControlMode;

constexpr double factor = 1.4142135623730951;
constexpr double least_tau_px = 1.0 / 64, largest_tau_px = 64;
constexpr double least_deadline_ms = 1, largest_deadline_ms = 2000;
/// While nothing moves each frame may take twice as long as the one before: what a flight has no time for, a
/// look has.
constexpr double most_patience = 4096;

class SceneSubject final : public ViewSubject {
 public:
  SceneSubject(const ViewSettings& settings, std::unique_ptr<ScenePlayer> player,
               view::CameraControls& controls)
      : s_(settings), controls_(controls), player_(std::move(player)) {
    options_.deadline_ms = settings.deadline_ms;
    options_.tau_px = std::clamp(settings.tau_px, least_tau_px, largest_tau_px);
  }

  bool is_empty() const override { return false; }
  std::string title() const override { return player_->file().path().filename().string(); }
  Result<void> draw_into(std::unique_ptr<GlContext> context) override;
  std::vector<Vec3d> points() const override { return player_->sketch(); }
  View first_view(const View& picture) const override;
  std::optional<Vec3d> hit(Vec3d origin, Vec3d direction) const override;
  std::string add(const std::filesystem::path& file) override {
    return file.filename().string() + ": a scene is shown by itself";
  }
  std::string act(Action action) override;
  Taken take(const WindowEvent& event) override;
  Result<ViewedFrame> frame(const ViewMoment& moment) override;
  Result<void> show(int width_px, int height_px, std::span<const TextBlock> text, int text_scale) override {
    return player_->renderer()->show(width_px, height_px, text, text_scale);
  }
  Result<Picture> read() override { return player_->picture(); }
  std::vector<std::string> statistics(const ViewTimes& times) const override;
  void record_frames() override { recorded_.emplace(); }
  std::string take_frames_csv() override {
    return scene_show::scene_frames_csv(
        std::exchange(recorded_, std::nullopt).value_or(std::vector<PlayedFrame>{}));
  }
  std::vector<Error> errors() const override {
    const auto all = player_->scene().store().errors();
    return {all.begin(), all.end()};
  }

 private:
  struct Grabbed {
    std::uint32_t node = 0;
    double depth = 0;  // of what is held: from the eye, along where it looks
  };

  bool deadline_binds() const {
    const ResolutionOutcome outcome = last_.report.outcome;
    return outcome != ResolutionOutcome::full && outcome != ResolutionOutcome::heuristic;
  }
  std::string change_tau(double by);
  std::string change_deadline(double by);
  std::string next_policy();
  std::string play_clip();
  std::string next_clip();
  void shade(Shading shading);
  bool grab(const WindowEvent& event);
  void pull(const WindowEvent& event);
  void look_under_pointer();
  void move_clip(double now_s);
  Result<void> play(double now_s);
  std::span<const SceneClip> clips() const { return player_->file().clips(); }

  const ViewSettings& s_;
  view::CameraControls& controls_;
  std::unique_ptr<ScenePlayer> player_;
  SceneFrameOptions options_;
  PlayedFrame last_;
  double patience_ = 1;  // times the deadline, while nothing moves
  bool calibrated_ = false, frozen_ = false;
  std::optional<std::vector<PlayedFrame>> recorded_;

  std::uint32_t clip_ = 0;
  double clip_s_ = 0;
  std::optional<double> clip_since_s_;  // the viewer's time at which the playing clip was at clip_s_

  std::optional<Grabbed> grabbed_;
  std::optional<std::array<double, 2>> pointer_;  // pixels
  std::string under_pointer_;
};

Result<void> SceneSubject::draw_into(std::unique_ptr<GlContext> context) {
  if (auto r = player_->draw_into(std::move(context)); !r) return r;
  const Box3d box = box_of(points());
  controls_.set_model_size(length(box.hi - box.lo));
  return {};
}

View SceneSubject::first_view(const View& picture) const {
  if (s_.camera) return camera_view(*s_.camera, picture, s_.up_given, std::nullopt);
  return fit_view(points(), three_quarter_direction(picture.up), picture);
}

std::optional<Vec3d> SceneSubject::hit(Vec3d origin, Vec3d direction) const {
  const auto part = scene_show::part_along(player_->scene(), origin, direction);
  if (!part) return {};
  return origin + direction * part->distance;
}

std::string SceneSubject::change_tau(double by) {
  options_.tau_px = std::clamp(options_.tau_px * by, least_tau_px, largest_tau_px);
  return fmt::format("nothing finer than tau {:.3g} px", options_.tau_px);
}

std::string SceneSubject::change_deadline(double by) {
  options_.deadline_ms = std::clamp(options_.deadline_ms * by, least_deadline_ms, largest_deadline_ms);
  return fmt::format("frames of {:.3g} ms", options_.deadline_ms);
}

std::string SceneSubject::next_policy() {
  LiveScene& scene = player_->scene();
  scene.set_policy(scene.policy() == PolicyKind::predictive ? PolicyKind::stress
                   : scene.policy() == PolicyKind::stress   ? PolicyKind::fixed
                                                            : PolicyKind::predictive);
  return fmt::format("policy {}", scene_show::name(scene.policy()));
}

std::string SceneSubject::play_clip() {
  if (clips().empty()) return "this scene has no clips";
  if (clip_since_s_)
    clip_since_s_.reset();
  else
    clip_since_s_ = clock_ms() / 1000 - clip_s_;
  return {};
}

std::string SceneSubject::next_clip() {
  if (clips().empty()) return "this scene has no clips";
  clip_ = (clip_ + 1) % static_cast<std::uint32_t>(clips().size());
  clip_s_ = 0;
  if (clip_since_s_) clip_since_s_ = clock_ms() / 1000;
  return fmt::format("clip {} of {}", clip_ + 1, clips().size());
}

void SceneSubject::shade(Shading shading) {
  Shading& now = player_->look().shading;
  now = now == shading ? Shading::lit : shading;
}

std::string SceneSubject::act(Action action) {
  switch (action) {
    case Action::tau_finer:
      return change_tau(1 / factor);
    case Action::tau_coarser:
      return change_tau(factor);
    case Action::less_time:
      return change_deadline(1 / factor);
    case Action::more_time:
      return change_deadline(factor);
    case Action::policy:
      return next_policy();
    case Action::clip_play:
      return play_clip();
    case Action::clip_next:
      return next_clip();
    case Action::freeze:
      frozen_ = !frozen_;
      return {};
    case Action::lit:
      player_->look().shading = Shading::lit;
      return {};
    case Action::wireframe:
      shade(Shading::wireframe);
      return {};
    case Action::normals:
      shade(Shading::normals);
      return {};
    default:
      return "only surfaces have that";
  }
}

/// @return true if there is a part under the pointer.
bool SceneSubject::grab(const WindowEvent& event) {
  const View& view = controls_.view();
  const Vec3d ray = view::ray_direction(view, event.x, event.y);
  const auto part = scene_show::part_along(player_->scene(), view.eye, ray);
  if (!part) return false;
  grabbed_ = {player_->scene().instances()[part->instance].node, -part->distance * dot(ray, view.frame()[2])};
  return true;
}

/// What was grabbed follows the pointer, as far from the eye's plane as it is.
void SceneSubject::pull(const WindowEvent& event) {
  const View& view = controls_.view();
  const auto [right, up, back] = view.frame();
  const double unit = grabbed_->depth / view.pixels_per_unit();
  player_->scene().pose().move(grabbed_->node, right * (event.dx * unit) - up * (event.dy * unit));
}

SceneSubject::Taken SceneSubject::take(const WindowEvent& event) {
  using Kind = WindowEvent::Kind;
  if (event.kind == Kind::leave) pointer_.reset(), grabbed_.reset();
  if (event.kind == Kind::move) pointer_ = {event.x, event.y};
  if (grabbed_) {
    if (event.kind == Kind::move) pull(event);
    if (event.kind == Kind::button_up) grabbed_.reset();
    return Taken::whole;
  }
  const bool grabs = event.kind == Kind::button_down && event.button == MouseButton::left && event.control;
  if (grabs) return grab(event) ? Taken::whole : Taken::no;
  return event.kind == Kind::move ? Taken::noticed : Taken::no;
}

void SceneSubject::look_under_pointer() {
  under_pointer_.clear();
  if (!pointer_) return;
  const View& view = controls_.view();
  const LiveScene& scene = player_->scene();
  const auto part =
      scene_show::part_along(scene, view.eye, view::ray_direction(view, (*pointer_)[0], (*pointer_)[1]));
  if (!part) return;
  const SceneInstance& in = scene.instances()[part->instance];
  const std::string& node = player_->file().nodes()[in.node].name;
  const ScenePartEntry& entry = player_->file().parts()[in.part];
  under_pointer_ =
      fmt::format("{}, {} triangles", node.empty() ? entry.name : node, with_commas(entry.triangles));
}

/// Again and again.
void SceneSubject::move_clip(double now_s) {
  if (!clip_since_s_) return;
  const double length_s = clips()[clip_].seconds();
  clip_s_ = length_s > 0 ? std::fmod(std::max(0.0, now_s - *clip_since_s_), length_s) : 0;
  player_->scene().pose().set_clip_time(clip_, clip_s_);
}

Result<void> SceneSubject::play(double now_s) {
  SceneFrameOptions options = options_;
  options.deadline_ms *= patience_;
  options.most_choice_ms = choice_share * options.deadline_ms;
  const View& view = controls_.view();
  if (!std::exchange(calibrated_, true))
    if (auto r = player_->calibrate({&view, 1}, options); !r) return r;
  auto played = player_->play(view, options, now_s);
  if (!played) return fail(played.error());
  last_ = *played;
  if (recorded_) recorded_->push_back(last_);
  return {};
}

Result<ViewedFrame> SceneSubject::frame(const ViewMoment& moment) {
  ViewedFrame made{true, true};
  if (frozen_) {
    made.drawn = moment.must_draw || !moment.was_at_rest;
    if (auto r = player_->draw(controls_.view()); !r) return fail(r.error());
  } else {
    move_clip(moment.now_s);
    const bool still = !moment.must_draw && !moment.in_flight && !clip_since_s_ && !grabbed_;
    patience_ = !still ? 1 : deadline_binds() ? std::min(2 * patience_, most_patience) : patience_;
    if (auto r = play(moment.now_s); !r) return fail(r.error());
    const bool gets_finer = deadline_binds() && patience_ < most_patience;
    made.settled = last_.report.settled && !clip_since_s_ && !gets_finer;
  }
  look_under_pointer();
  return made;
}

std::vector<std::string> SceneSubject::statistics(const ViewTimes& times) const {
  scene_show::SceneStatistics s;
  s.title = title();
  s.driver = player_->renderer()->driver();
  s.policy = player_->scene().policy();
  s.frame = last_;
  s.frame_ms = times.frame_ms;
  s.tau_px = options_.tau_px;
  s.camera = controls_.mode() == ControlMode::orbit ? "orbit"
             : controls_.mode() == ControlMode::fly ? fmt::format("fly, {:.3g} units/s", controls_.speed())
                                                    : fmt::format("walk, {:.3g} units/s", controls_.speed());
  if (!clips().empty())
    s.clip = {clips()[clip_].name, clip_s_, clips()[clip_].seconds(), clip_since_s_.has_value()};
  s.pointer = under_pointer_;
  s.cache_bytes = s_.cache_bytes;
  s.unreadable_parts = errors().size();
  s.frozen = frozen_;
  return scene_show::statistics_lines(s);
}

}  // namespace

Result<std::unique_ptr<ViewSubject>> open_scene_subject(const ViewSettings& s,
                                                        const std::filesystem::path& file,
                                                        view::CameraControls& controls) {
  if (s.shading == Shading::relief || s.exaggeration != 1)
    return fail(ErrorCode::invalid_input, file.string(), "--shading, --exaggerate",
                "a scene is no terrain: there is no height in it; leave the option out");
  auto player = ScenePlayer::open(file, player_settings(s), clock_ms);
  if (!player) return fail(player.error());
  return std::make_unique<SceneSubject>(s, std::move(*player), controls);
}

}  // namespace cuesta::app
