#pragma once
/// Draws a DrawList with OpenGL 3.3 core into an off-screen picture.

#include <cstdint>
#include <memory>

#include "ooc/result.h"
#include "runtime/draw/gl_context.h"
#include "runtime/draw/picture.h"
#include "runtime/draw_list.h"
#include "runtime/view.h"

namespace cuesta {

enum class Shading : std::uint8_t {
  lit,        ///< key light, soft fill, sky and ground, a gentle gloss
  wireframe,  ///< lit, with the edges of the visible triangles drawn over it
  normals,    ///< rgb = (n + 1) / 2 · 255, n in the camera's frame (right, up, back)
};

struct DrawOptions {
  Shading shading = Shading::lit;
  Rgba8 background{255, 255, 255, 255};
  Rgba8 surface_colour{232, 226, 216,
                       255};  ///< multiplies the vertices' colours; warm light grey. White: as they are
  Vec3d light_direction{-0.35, 0.55,
                        0.75};  ///< towards the key light, in the camera's frame; need not be unit, not zero
  bool cull_back_faces =
      false;              ///< off: back faces are drawn in a muted blue, so that holes and inversions show
  bool antialias = true;  ///< 4 samples per pixel where the driver has them
};

/// Threads: one at a time. Owns about 8 bytes per sample and 4 per pixel of the last
/// picture's size, and GPU copies of the pools.
class Renderer {
 public:
  /// @error io with the driver's message when an entry point or a shader is refused.
  static Result<std::unique_ptr<Renderer>> create(std::unique_ptr<GlContext> context);
  virtual ~Renderer() = default;

  /// Uploads what changed and draws. The first list, and one whose pool has outgrown the GPU's copy, is
  /// uploaded whole; otherwise what is not in a changed range is what it was. There is no far plane, and
  /// nothing nearer than half a grid step is drawn; depth resolves 10^-6 of the distance everywhere.
  /// @pre   draws and changed ranges lie in the pools, drawn indices are below vertices.size(); view is
  /// valid.
  /// @error invalid_input if the view is larger than the driver allows; out_of_budget if it runs out of
  /// memory;
  ///        io for what else it reports.
  virtual Result<void> draw(const DrawList& list, const View& view, const DrawOptions& options) = 0;
  /// The picture last drawn. Waits until it is finished.   @error invalid_input before the first draw; io.
  virtual Result<Picture> read() = 0;
};

}  // namespace cuesta
