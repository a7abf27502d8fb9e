#pragma once
/// What all renderers do alike: how they come to be, what they set before a picture, what they do with it
/// then.

#include <memory>
#include <span>

#include "ooc/check.h"
#include "runtime/draw/frame_target.h"
#include "runtime/draw/gl_program.h"
#include "runtime/draw/renderer.h"
#include "runtime/draw/text_painter.h"

namespace cuesta {

inline constexpr int antialias_samples = 4;

Vec3f linear_from_srgb(Rgba8 colour);

/// Clears the bound framebuffer, for reversed depth. @pre its size is set
void clear_picture(const GlFunctions& gl, const DrawOptions& options);
/// Uniforms of light and surface colour.   @pre the program is in use
void set_lights(const GlFunctions& gl, const GlProgram& program, const DrawOptions& options);

/// Renderer::read().   @pre the context is current
Result<Picture> read_drawn(const GlFunctions& gl, const FrameTarget& target);
/// Renderer::show().   @pre the context is current
Result<void> show_drawn(const GlFunctions& gl, const FrameTarget& target, TextPainter& painter, int width_px,
                        int height_px, std::span<const TextBlock> text, int text_scale);

tl::unexpected<Error> not_current();

/// Renderer::create(), for an implementation of `Interface` with a constructor (context, functions) and
/// compile().
template <class Interface, class Implementation>
Result<std::unique_ptr<Interface>> create_renderer(std::unique_ptr<GlContext> context) {
  CUESTA_CHECK(context != nullptr);
  if (!context->make_current()) return not_current();
  const auto gl = load_gl_functions(*context);
  if (!gl) return fail(gl.error());
  auto renderer = std::make_unique<Implementation>(std::move(context), *gl);
  if (auto ok = renderer->compile(); !ok) return fail(ok.error());
  return std::unique_ptr<Interface>(std::move(renderer));
}

}  // namespace cuesta
