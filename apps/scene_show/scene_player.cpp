#include "apps/scene_show/scene_player.h"

#include <algorithm>

#include "runtime/scene_sources.h"

namespace cuesta::scene_show {
namespace {

/// Of the scene's diagonal: what is nearer is not drawn.
constexpr double nearest_share = 1e-6;

}  // namespace

Result<std::unique_ptr<ScenePlayer>> ScenePlayer::open(const std::filesystem::path& path,
                                                       const PlayerSettings& settings, Clock clock) {
  auto file = SceneFile::open(path);
  if (!file) return fail(file.error());
  auto player = std::unique_ptr<ScenePlayer>(new ScenePlayer(std::move(*file), settings, clock));
  const std::uint32_t threads = settings.scene.load_threads;
  auto scene = LiveScene::open(player->file_.directory(), sources_of(player->file_, clock, threads),
                               settings.scene, clock);
  if (!scene) return fail(scene.error());
  player->scene_ = std::move(*scene);
  const Box3d box = player->scene_->bounds();
  if (!box.empty()) player->nearest_ = std::max(nearest_share * length(box.hi - box.lo), 1e-300);
  return player;
}

Result<void> ScenePlayer::draw_into(std::unique_ptr<GlContext> context) {
  auto renderer = SceneRenderer::create(std::move(context));
  if (!renderer) return fail(renderer.error());
  renderer_ = std::move(*renderer);
  return {};
}

Result<void> ScenePlayer::draw(const View& view) {
  if (!renderer_) return {};
  if (auto ok = renderer_->draw(scene_->list(), view, nearest_, settings_.draw); !ok) return ok;
  renderer_->finish();
  return {};
}

Result<void> ScenePlayer::calibrate(std::span<const View> views, const SceneFrameOptions& options) {
  if (!renderer_) return {};
  std::vector<MeasuredFrame> measured;
  SceneFrameOptions at = options;
  for (const View& view : views) {
    double last_ms = 0;
    for (const double share : {0.0, 0.03, 0.1, 0.3, 1.0}) {
      if (last_ms > 2 * options.deadline_ms) break;  // such a frame will not be asked for
      at.uniform = share;
      scene_->settle(view, at);
      if (auto ok = draw(view); !ok) return ok;  // what is new is sent
      for (int i = 0; i < 3; ++i) {
        const double start = clock_();
        const double choice_ms = scene_->frame(view, at).choice_ms;
        if (auto ok = draw(view); !ok) return ok;
        last_ms = clock_() - start;
        scene_->drew(renderer_->fill());
        measured.push_back({scene_->work(), last_ms - choice_ms, scene_->guess()});
      }
    }
  }
  scene_->calibrate(measured);
  return {};
}

Result<PlayedFrame> ScenePlayer::play(const View& view, const SceneFrameOptions& options, double time_s) {
  const double start = clock_();
  PlayedFrame frame;
  frame.time_s = time_s;
  frame.report = scene_->frame(view, options);
  if (auto ok = draw(view); !ok) return fail(ok.error());
  frame.actual_ms = clock_() - start;
  if (!renderer_) return frame;
  scene_->drew(renderer_->fill());
  scene_->measured(frame.actual_ms);
  return frame;
}

Result<PlayedFrame> ScenePlayer::settle(const View& view, const SceneFrameOptions& options) {
  const double start = clock_();
  PlayedFrame frame;
  frame.report = scene_->settle(view, options);
  if (auto ok = draw(view); !ok) return fail(ok.error());
  frame.actual_ms = clock_() - start;
  return frame;
}

}  // namespace cuesta::scene_show
