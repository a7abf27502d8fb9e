#pragma once
/// Draws DrawLists with OpenGL 3.3 core into an off-screen picture, and shows it in a window.

#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>

#include "ooc/result.h"
#include "runtime/draw/gl_context.h"
#include "runtime/draw/picture.h"
#include "runtime/draw/text_overlay.h"
#include "runtime/draw_list.h"
#include "runtime/relief.h"
#include "runtime/view.h"

namespace cuesta {

enum class Shading : std::uint8_t {
  lit,        ///< key light, soft fill, sky and ground, a gentle gloss
  wireframe,  ///< lit, with the edges of the visible triangles drawn over it
  normals,    ///< rgb = (n + 1) / 2 · 255, n in the camera's frame (right, up, back)
  changes,    ///< lit, by DrawList::triangle_tags: unchanged light, the coarse path grey, the fine path dark
  pages,      ///< lit, a colour for each page
  relief,     ///< DrawOptions::relief: lit from the north-west of each place, coloured by height
};

/// Colours of heights for Shading::relief: blue at and below the sea, then green, ochre and brown to rock and
/// snow. In world units: the ramp runs from `least` (or the sea's level, if that is higher) to `most`, the
/// sea's from its level down to `least`.
struct HeightColours {
  double least = 0, most = 0, sea_level = 0;
  bool vertex_colours = false;  ///< the vertices' colours instead, as of a draped image
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
  bool page_borders = false;  ///< red lines where pixels of different pages meet
  /// Up and heights of terrain; in all shadings heights are drawn exaggerated by it. Holds for all objects.
  std::optional<Relief> relief = {};
  HeightColours heights = {};
};

/// What the last draw() sent to the GPU.
struct UploadReport {
  std::uint64_t bytes = 0;
  std::uint32_t calls = 0;
};

/// Threads: one at a time, of those that may use the context. Owns about 8 bytes per sample and 4 per pixel
/// of the last picture's size, and GPU copies of the pools.
class Renderer {
 public:
  /// @error io with the driver's message when an entry point or a shader is refused.
  static Result<std::unique_ptr<Renderer>> create(std::unique_ptr<GlContext> context);
  virtual ~Renderer() = default;

  /// Uploads what changed and draws the objects of one world. An object is known by its place in `lists`: its
  /// first list is uploaded whole; later what is not in a changed range is what it was or is not drawn, also
  /// where the pools have grown; so what was morphed and is no more is in a changed range. Objects beyond the
  /// last are forgotten. There is no far plane, and nothing nearer than half of the finest grid step is
  /// drawn; depth resolves 10^-6 of the distance everywhere. One call draws an object, but for the debug
  /// shadings and page borders, which take one for each page. Uploads take at most some 500 calls for each
  /// pool.
  /// @pre   draws and changed ranges lie in the pools, drawn indices are below vertices.size(); view is
  /// valid.
  /// @error invalid_input if the view is larger than the driver allows; out_of_budget if it runs out of
  /// memory;
  ///        io for what else it reports.
  virtual Result<void> draw(std::span<const DrawList> lists, const View& view,
                            const DrawOptions& options) = 0;
  Result<void> draw(const DrawList& list, const View& view, const DrawOptions& options) {
    return draw(std::span(&list, 1), view, options);
  }
  /// The picture last drawn. Waits until it is finished.   @error invalid_input before the first draw; io.
  virtual Result<Picture> read() = 0;
  /// Copies the picture last drawn into the context's own framebuffer, scaled to its size, with text over it.
  /// The picture that read() gives has no text.
  /// @param text_scale  pixels per pixel of the font, ≥ 1.   @error io.
  virtual Result<void> show(int width_px, int height_px, std::span<const TextBlock> text, int text_scale) = 0;
  virtual UploadReport uploads() const = 0;
  /// Context and driver, as in "egl, llvmpipe (LLVM 15.0.6, 256 bits)".
  virtual const std::string& driver() const = 0;
};

}  // namespace cuesta
