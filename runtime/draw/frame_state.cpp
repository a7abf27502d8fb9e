#include "runtime/draw/frame_state.h"

#include <cmath>

namespace cuesta {
namespace {

float linear_from_srgb(std::uint8_t value) {
  const double c = value / 255.0;
  return static_cast<float>(c <= 0.04045 ? c / 12.92 : std::pow((c + 0.055) / 1.055, 2.4));
}

}  // namespace

Vec3f linear_from_srgb(Rgba8 colour) {
  return {linear_from_srgb(colour[0]), linear_from_srgb(colour[1]), linear_from_srgb(colour[2])};
}

void clear_picture(const GlFunctions& gl, const DrawOptions& options) {
  const Vec3f background = linear_from_srgb(options.background);
  gl.Enable(GL_FRAMEBUFFER_SRGB);
  gl.Enable(GL_DEPTH_TEST);
  gl.DepthFunc(GL_GREATER);
  if (gl.ClipControl) gl.ClipControl(GL_LOWER_LEFT, GL_ZERO_TO_ONE);
  (options.cull_back_faces ? gl.Enable : gl.Disable)(GL_CULL_FACE);
  gl.ClearColor(background.x, background.y, background.z, static_cast<float>(options.background[3]) / 255.0f);
  gl.ClearDepth(0);
  gl.Clear(GL_COLOR_BUFFER_BIT | GL_DEPTH_BUFFER_BIT);
}

void set_lights(const GlFunctions& gl, const GlProgram& program, const DrawOptions& options) {
  const Vec3f tint = linear_from_srgb(options.surface_colour);
  const Vec3f key = vec_cast<float>(normalized(options.light_direction));
  // From the other side and below, more from the side: straight below, sky and fill would cancel to flat
  // shadows.
  const Vec3f fill = normalized(Vec3f{-2 * key.x, -0.5f * key.y, 0.5f * key.z});
  gl.Uniform3f(program.uniform("surface_colour"), tint.x, tint.y, tint.z);
  gl.Uniform3f(program.uniform("key_direction"), key.x, key.y, key.z);
  gl.Uniform3f(program.uniform("fill_direction"), fill.x, fill.y, fill.z);
}

Result<Picture> read_drawn(const GlFunctions& gl, const FrameTarget& target) {
  Picture picture = target.read();
  if (picture.pixels.empty()) return fail(ErrorCode::invalid_input, "", "", "nothing has been drawn yet");
  if (auto ok = check_gl_errors(gl, "reading the picture"); !ok) return fail(ok.error());
  return picture;
}

Result<void> show_drawn(const GlFunctions& gl, const FrameTarget& target, TextPainter& painter, int width_px,
                        int height_px, std::span<const TextBlock> text, int text_scale) {
  target.copy_to_window(width_px, height_px);
  gl.Viewport(0, 0, width_px, height_px);
  painter.draw(lay_out(text, text_scale, width_px, height_px), width_px, height_px);
  return check_gl_errors(gl, "showing the picture");
}

tl::unexpected<Error> not_current() {
  return fail(ErrorCode::io, "", "", "the OpenGL context cannot be made current");
}

}  // namespace cuesta
