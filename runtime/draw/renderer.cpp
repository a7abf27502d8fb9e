#include "runtime/draw/renderer.h"

#include <cmath>
#include <cstddef>
#include <limits>
#include <optional>

#include "ooc/check.h"
#include "runtime/draw/camera_matrices.h"
#include "runtime/draw/frame_target.h"
#include "runtime/draw/gl_pool.h"
#include "runtime/draw/gl_program.h"
#include "runtime/draw/surface_shaders.h"

namespace cuesta {
namespace {

constexpr int antialias_samples = 4;
constexpr std::size_t shading_count = 3;

float linear_from_srgb(std::uint8_t value) {
  const double c = value / 255.0;
  return static_cast<float>(c <= 0.04045 ? c / 12.92 : std::pow((c + 0.055) / 1.055, 2.4));
}

Vec3f linear_from_srgb(Rgba8 colour) {
  return {linear_from_srgb(colour[0]), linear_from_srgb(colour[1]), linear_from_srgb(colour[2])};
}

tl::unexpected<Error> not_current() {
  return fail(ErrorCode::io, "", "", "the OpenGL context cannot be made current");
}

/// The draw ranges in the form of glMultiDrawElements; kept to be reused.
struct MultiDraw {
  std::vector<GLsizei> counts;
  std::vector<const void*> offsets;

  void set(const DrawList& list) {
    counts.clear();
    offsets.clear();
    for (const Range& range : list.draws) {
      CUESTA_CHECK(std::uint64_t{range.first} + range.count <= list.indices.size(), range.first, range.count);
      CUESTA_CHECK(range.count <= static_cast<std::uint32_t>(std::numeric_limits<GLsizei>::max()),
                   range.count);
      counts.push_back(static_cast<GLsizei>(range.count));
      offsets.push_back(reinterpret_cast<const void*>(std::uintptr_t{range.first} * sizeof(std::uint32_t)));
    }
  }
};

class GlRenderer final : public Renderer {
 public:
  GlRenderer(std::unique_ptr<GlContext> context, const GlFunctions& gl);
  ~GlRenderer() override {
    context_->make_current();  // the members' destructors delete from it
    gl_.DeleteVertexArrays(1, &vertex_array_);
  }
  GlRenderer(const GlRenderer&) = delete;
  GlRenderer& operator=(const GlRenderer&) = delete;

  /// Compiles every shading, so that a driver's refusal shows at once.
  Result<void> compile();
  Result<void> draw(const DrawList& list, const View& view, const DrawOptions& options) override;
  Result<Picture> read() override;

 private:
  void describe_vertices();
  void set_state(const DrawOptions& options);
  void set_uniforms(const GlProgram& program, const CameraMatrices& camera, const DrawOptions& options);

  std::unique_ptr<GlContext> context_;
  GlFunctions gl_;
  std::array<std::optional<GlProgram>, shading_count> programs_;
  GLuint vertex_array_ = 0;
  GlPool vertices_;
  GlPool indices_;
  FrameTarget target_;
  MultiDraw multi_draw_;
};

GlRenderer::GlRenderer(std::unique_ptr<GlContext> context, const GlFunctions& gl)
    : context_(std::move(context)),
      gl_(gl),
      vertices_(gl_, GL_ARRAY_BUFFER),
      indices_(gl_, GL_ELEMENT_ARRAY_BUFFER),
      target_(gl_) {
  gl_.GenVertexArrays(1, &vertex_array_);
  describe_vertices();
}

void GlRenderer::describe_vertices() {
  const auto offset = [](std::size_t bytes) { return reinterpret_cast<const void*>(bytes); };
  constexpr GLsizei stride = sizeof(DrawVertex);
  gl_.BindVertexArray(vertex_array_);
  vertices_.bind();
  gl_.VertexAttribIPointer(position_attribute, 3, GL_INT, stride, offset(offsetof(DrawVertex, x)));
  gl_.VertexAttribIPointer(normal_attribute, 2, GL_SHORT, stride, offset(offsetof(DrawVertex, normal_u)));
  gl_.VertexAttribPointer(colour_attribute, 4, GL_UNSIGNED_BYTE, GL_TRUE, stride,
                          offset(offsetof(DrawVertex, colour)));
  for (const GLuint attribute : {position_attribute, normal_attribute, colour_attribute})
    gl_.EnableVertexAttribArray(attribute);
  indices_.bind();
}

Result<void> GlRenderer::compile() {
  for (std::size_t i = 0; i < shading_count; ++i) {
    auto program = GlProgram::link(gl_, surface_shaders(static_cast<Shading>(i), gl_.ClipControl == nullptr));
    if (!program) return fail(program.error());
    programs_[i].emplace(std::move(*program));
  }
  return check_gl_errors(gl_, "setting up");
}

void GlRenderer::set_state(const DrawOptions& options) {
  const Vec3f background = linear_from_srgb(options.background);
  gl_.Enable(GL_FRAMEBUFFER_SRGB);
  gl_.Enable(GL_DEPTH_TEST);
  gl_.DepthFunc(GL_GREATER);
  if (gl_.ClipControl) gl_.ClipControl(GL_LOWER_LEFT, GL_ZERO_TO_ONE);
  (options.cull_back_faces ? gl_.Enable : gl_.Disable)(GL_CULL_FACE);
  gl_.ClearColor(background.x, background.y, background.z,
                 static_cast<float>(options.background[3]) / 255.0f);
  gl_.ClearDepth(0);
  gl_.Clear(GL_COLOR_BUFFER_BIT | GL_DEPTH_BUFFER_BIT);
}

void GlRenderer::set_uniforms(const GlProgram& program, const CameraMatrices& camera,
                              const DrawOptions& options) {
  const Vec3f tint = linear_from_srgb(options.surface_colour);
  const Vec3f key = vec_cast<float>(normalized(options.light_direction));
  // From the other side and below, more from the side: straight below, sky and fill would cancel to flat
  // shadows.
  const Vec3f fill = normalized(Vec3f{-2 * key.x, -0.5f * key.y, 0.5f * key.z});
  program.use();
  gl_.Uniform3i(program.uniform("eye_whole"), camera.eye_whole.x, camera.eye_whole.y, camera.eye_whole.z);
  gl_.Uniform3f(program.uniform("eye_part"), camera.eye_part.x, camera.eye_part.y, camera.eye_part.z);
  gl_.UniformMatrix3fv(program.uniform("rotation"), 1, GL_TRUE, camera.rotation.data());
  gl_.Uniform2f(program.uniform("focal"), camera.focal[0], camera.focal[1]);
  gl_.Uniform1f(program.uniform("near_units"), camera.near_units);
  gl_.Uniform3f(program.uniform("surface_colour"), tint.x, tint.y, tint.z);
  gl_.Uniform3f(program.uniform("key_direction"), key.x, key.y, key.z);
  gl_.Uniform3f(program.uniform("fill_direction"), fill.x, fill.y, fill.z);
}

Result<void> GlRenderer::draw(const DrawList& list, const View& view, const DrawOptions& options) {
  if (!context_->make_current()) return not_current();
  gl_.BindVertexArray(vertex_array_);
  vertices_.upload(list.vertices, list.changed_vertices);
  for (const MorphedVertex& m : list.morphed) vertices_.put(m.slot, m.vertex);
  indices_.upload(list.indices, list.changed_indices);
  multi_draw_.set(list);
  const auto begun = target_.begin(view.width_px, view.height_px, options.antialias ? antialias_samples : 1);
  if (!begun) return begun;
  set_state(options);
  set_uniforms(*programs_[static_cast<std::size_t>(options.shading)], camera_matrices(view, list.grid),
               options);
  if (!multi_draw_.counts.empty())
    gl_.MultiDrawElements(GL_TRIANGLES, multi_draw_.counts.data(), GL_UNSIGNED_INT,
                          multi_draw_.offsets.data(), static_cast<GLsizei>(multi_draw_.counts.size()));
  target_.end();
  return check_gl_errors(gl_, "drawing");
}

Result<Picture> GlRenderer::read() {
  if (!context_->make_current()) return not_current();
  Picture picture = target_.read();
  if (picture.pixels.empty()) return fail(ErrorCode::invalid_input, "", "", "nothing has been drawn yet");
  if (auto ok = check_gl_errors(gl_, "reading the picture"); !ok) return fail(ok.error());
  return picture;
}

}  // namespace

Result<std::unique_ptr<Renderer>> Renderer::create(std::unique_ptr<GlContext> context) {
  CUESTA_CHECK(context != nullptr);
  if (!context->make_current()) return not_current();
  const auto gl = load_gl_functions(*context);
  if (!gl) return fail(gl.error());
  auto renderer = std::make_unique<GlRenderer>(std::move(context), *gl);
  if (auto ok = renderer->compile(); !ok) return fail(ok.error());
  return std::unique_ptr<Renderer>(std::move(renderer));
}

}  // namespace cuesta
