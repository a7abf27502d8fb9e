#pragma once
/// Draws a DrawList with OpenGL 3.3 core into an off-screen picture.

#include <array>
#include <cstdint>
#include <memory>
#include <vector>

#include "ooc/result.h"
#include "runtime/draw/gl_context.h"
#include "runtime/draw_list.h"
#include "runtime/view.h"

namespace cuesta {

/// 8-bit RGBA, sRGB, rows from the top.
struct Picture {
  int width_px = 0;
  int height_px = 0;
  std::vector<Rgba8> pixels;
};

enum class Shading : std::uint8_t { lit, wireframe, normals };

struct DrawOptions {
  Shading shading = Shading::lit;
  Rgba8 background{255, 255, 255, 255};
  Vec3d light_direction{-0.35, 0.55, 0.75};  ///< towards the light, in the camera's frame (a headlight from upper left)
  bool cull_back_faces = false;              ///< off: back faces are drawn in a bluish shade, so that inversions show
};

class Renderer {
 public:
  /// @error io with the driver's message when a shader or a framebuffer is refused.
  static Result<std::unique_ptr<Renderer>> create(std::unique_ptr<GlContext> context);
  virtual ~Renderer() = default;

  /// Uploads what changed and draws. The near and far planes follow from the drawn vertices' bounds.
  virtual Result<void> draw(const DrawList& list, const View& view, const DrawOptions& options) = 0;
  /// The picture last drawn.
  virtual Result<Picture> read() = 0;
};

}  // namespace cuesta
