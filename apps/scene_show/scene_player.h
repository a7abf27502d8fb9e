#pragma once
/// A .cuesta scene shown frame by frame under a deadline: chosen, drawn, measured. What render and the
/// benchmark share.

#include <filesystem>
#include <memory>
#include <optional>
#include <span>

#include "hierarchy/scene_file.h"
#include "runtime/draw/scene_renderer.h"
#include "runtime/live_scene.h"

namespace cuesta::scene_show {

struct PlayerSettings {
  SceneSettings scene;
  DrawOptions draw;
};

struct PlayedFrame {
  double time_s = 0;
  SceneFrameReport report;
  double actual_ms =
      0;  ///< choice, upload and drawing, until the picture is finished; without reading it back
};

class ScenePlayer {
 public:
  /// Nothing is drawn yet, only chosen.   @error of opening the file or a large part
  static Result<std::unique_ptr<ScenePlayer>> open(const std::filesystem::path& path,
                                                   const PlayerSettings& settings, Clock clock);
  /// From now on frames are drawn.   @error of the driver
  Result<void> draw_into(std::unique_ptr<GlContext> context);
  /// How they are drawn.
  DrawOptions& look() { return settings_.draw; }

  /// Draws some frames at several resolutions from each view, and fits the cost model to what they took. The
  /// cache is warm for these views then.
  Result<void> calibrate(std::span<const View> views, const SceneFrameOptions& options);
  /// One frame; cost model and policy learn from it.
  Result<PlayedFrame> play(const View& view, const SceneFrameOptions& options, double time_s = 0);
  /// Draws what the last frame has chosen once more, as seen from `view`.
  Result<void> draw(const View& view);
  /// Draws what a settled frame shows.
  Result<PlayedFrame> settle(const View& view, const SceneFrameOptions& options);
  Result<Picture> picture() { return renderer_->read(); }

  LiveScene& scene() { return *scene_; }
  const SceneFile& file() const { return file_; }
  SceneRenderer* renderer() { return renderer_.get(); }  ///< null where nothing is drawn
  /// Corners of the scene's box, and the middles of some instances: to place cameras. Never empty.
  std::vector<Vec3d> sketch() const { return scene_->corners(); }

 private:
  ScenePlayer(SceneFile file, const PlayerSettings& settings, Clock clock)
      : file_(std::move(file)), settings_(settings), clock_(std::move(clock)) {}

  SceneFile file_;
  PlayerSettings settings_;
  Clock clock_;
  std::unique_ptr<LiveScene> scene_;
  std::unique_ptr<SceneRenderer> renderer_;
  double nearest_ = 1e-6;
};

}  // namespace cuesta::scene_show
