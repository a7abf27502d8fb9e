#pragma once
/// Draws SceneDrawLists with OpenGL 3.3 core into an off-screen picture, and shows it in a window: one call
/// for each group of instances.

#include <memory>
#include <span>
#include <string>

#include "ooc/result.h"
#include "runtime/draw/gl_context.h"
#include "runtime/draw/renderer.h"
#include "runtime/live_scene.h"

namespace cuesta {

/// Threads: one at a time, of those that may use the context. Owns GPU copies of parts (20 bytes per vertex)
/// and index blocks (12 per triangle) that were drawn in the last `kept_frames` pictures.
class SceneRenderer {
 public:
  static constexpr int kept_frames = 60;

  /// @error io with the driver's message when an entry point or a shader is refused.
  static Result<std::unique_ptr<SceneRenderer>> create(std::unique_ptr<GlContext> context);
  virtual ~SceneRenderer() = default;

  /// Nothing nearer than `nearest` is drawn; depth resolves 10^-7 of the distance everywhere.
  /// @param nearest  world units > 0
  /// @param options  shading lit, wireframe or normals; page borders and relief are of surfaces and are
  /// ignored. Both sides of triangles have the instance's colour.
  /// @error as Renderer::draw()
  virtual Result<void> draw(const SceneDrawList& list, const View& view, double nearest,
                            const DrawOptions& options) = 0;
  /// As of Renderer.
  virtual Result<Picture> read() = 0;
  virtual Result<void> show(int width_px, int height_px, std::span<const TextBlock> text, int text_scale) = 0;
  /// Returns when the picture last drawn is finished; what a measured time must include.
  virtual void finish() = 0;
  /// What the picture last drawn has filled: one for each group of its list, then one for each surface. For
  /// LiveScene::drew(). Waits as finish() does.
  virtual std::span<const CallFill> fill() = 0;
  virtual UploadReport uploads() const = 0;
  virtual const std::string& driver() const = 0;
};

}  // namespace cuesta
