#pragma once
/// What all renderers set before they draw a picture.

#include "runtime/draw/gl_program.h"
#include "runtime/draw/renderer.h"

namespace cuesta {

inline constexpr int antialias_samples = 4;

Vec3f linear_from_srgb(Rgba8 colour);

/// Clears the bound framebuffer, for reversed depth. @pre its size is set
void clear_picture(const GlFunctions& gl, const DrawOptions& options);
/// Uniforms of light and surface colour.   @pre the program is in use
void set_lights(const GlFunctions& gl, const GlProgram& program, const DrawOptions& options);

}  // namespace cuesta
