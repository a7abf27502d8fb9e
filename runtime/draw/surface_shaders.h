#pragma once
/// The GLSL of surfaces: from pool vertices to lit, wireframe or normal-coloured pixels.

#include "runtime/draw/gl_program.h"
#include "runtime/draw/renderer.h"

namespace cuesta {

/// Attribute locations that the vertex shader declares.
enum SurfaceAttribute : GLuint { position_attribute = 0, normal_attribute = 1, colour_attribute = 2 };
/// Of an instance, in instance_shaders().
enum InstanceAttribute : GLuint { first_row_attribute = 3, tint_attribute = 6 };

/// OpenGL 3.3 core, or OpenGL ES 3.0 as of WebGL 2, which has no Shading::wireframe and Shading::changes.
enum class ShaderDialect : std::uint8_t { core_330, es_300 };

/// @param fragment_depth  the fragment shader writes the reversed depth itself (slower: no early depth test),
/// for
///                        drivers without glClipControl.
/// Uniforms of each drawn range: `page` for Shading::pages; `first_triangle` for Shading::changes, which also
/// has the buffer texture `triangle_tags` and its length `tag_count`.
ShaderSources surface_shaders(Shading shading, bool fragment_depth,
                              ShaderDialect dialect = ShaderDialect::core_330);
/// For instances of parts: `anchor`, and the instance's map and tint as attributes. Both sides have the
/// surface's colour: parts of scenes are often open, and wound either way.
/// @param shading  lit, wireframe or normals
ShaderSources instance_shaders(Shading shading, bool fragment_depth,
                               ShaderDialect dialect = ShaderDialect::core_330);
/// Writes `page` + 1 into an unsigned integer target; 0 is left where nothing is drawn.
ShaderSources page_number_shaders(bool fragment_depth);

}  // namespace cuesta
