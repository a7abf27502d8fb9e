#include "runtime/draw/renderer.h"

#include <array>
#include <cmath>
#include <optional>
#include <vector>

#include "ooc/check.h"
#include "runtime/draw/camera_matrices.h"
#include "runtime/draw/frame_state.h"
#include "runtime/draw/frame_target.h"
#include "runtime/draw/gl_program.h"
#include "runtime/draw/gpu_object.h"
#include "runtime/draw/page_borders.h"
#include "runtime/draw/relief_uniforms.h"
#include "runtime/draw/surface_shaders.h"
#include "runtime/draw/text_painter.h"

namespace cuesta {
namespace {

constexpr std::size_t shading_count = 6;

class GlRenderer final : public Renderer {
 public:
  GlRenderer(std::unique_ptr<GlContext> context, const GlFunctions& gl);
  ~GlRenderer() override {
    context_->make_current();  // the members' destructors delete from it
  }
  GlRenderer(const GlRenderer&) = delete;
  GlRenderer& operator=(const GlRenderer&) = delete;

  using Renderer::draw;
  /// Compiles every shading, so that a driver's refusal shows at once.
  Result<void> compile();
  Result<void> draw(std::span<const DrawList> lists, const View& view, const DrawOptions& options) override;
  Result<Picture> read() override;
  Result<void> show(int width_px, int height_px, std::span<const TextBlock> text, int text_scale) override;
  UploadReport uploads() const override { return {uploads_.bytes, uploads_.calls}; }
  const std::string& driver() const override { return driver_; }

 private:
  void upload(std::span<const DrawList> lists);
  void set_uniforms(const GlProgram& program, const CameraMatrices& camera, const DrawOptions& options);
  void set_relief(const GlProgram& program, const Grid& grid, const View& view, const DrawOptions& options);
  void draw_objects(std::span<const DrawList> lists, const View& view, const DrawOptions& options);
  void draw_page_numbers(std::span<const DrawList> lists, const View& view, const DrawOptions& options);

  std::unique_ptr<GlContext> context_;
  GlFunctions gl_;
  std::string driver_;
  std::array<std::optional<GlProgram>, shading_count> programs_;
  std::vector<std::unique_ptr<GpuObject>> objects_;
  FrameTarget target_;
  PageBorders borders_;
  TextPainter text_;
  UploadCount uploads_;
};

GlRenderer::GlRenderer(std::unique_ptr<GlContext> context, const GlFunctions& gl)
    : context_(std::move(context)), gl_(gl), target_(gl_), borders_(gl_), text_(gl_) {
  const GLubyte* const name = gl_.GetString(GL_RENDERER);
  driver_ =
      std::string(context_->kind()) + ", " + (name ? reinterpret_cast<const char*>(name) : "unnamed driver");
}

Result<void> GlRenderer::compile() {
  for (std::size_t i = 0; i < shading_count; ++i) {
    auto program = GlProgram::link(gl_, surface_shaders(static_cast<Shading>(i), gl_.ClipControl == nullptr));
    if (!program) return fail(program.error());
    programs_[i].emplace(std::move(*program));
  }
  if (auto ok = borders_.compile(gl_.ClipControl == nullptr); !ok) return ok;
  if (auto ok = text_.compile(); !ok) return ok;
  return check_gl_errors(gl_, "setting up");
}

void GlRenderer::set_uniforms(const GlProgram& program, const CameraMatrices& camera,
                              const DrawOptions& options) {
  program.use();
  gl_.Uniform3i(program.uniform("eye_whole"), camera.eye_whole.x, camera.eye_whole.y, camera.eye_whole.z);
  gl_.Uniform3f(program.uniform("eye_part"), camera.eye_part.x, camera.eye_part.y, camera.eye_part.z);
  gl_.UniformMatrix3fv(program.uniform("rotation"), 1, GL_TRUE, camera.rotation.data());
  gl_.Uniform2f(program.uniform("focal"), camera.focal[0], camera.focal[1]);
  gl_.Uniform1f(program.uniform("near_units"), camera.near_units);
  set_lights(gl_, program, options);
}

void GlRenderer::set_relief(const GlProgram& program, const Grid& grid, const View& view,
                            const DrawOptions& options) {
  const HeightColours& h = options.heights;
  const Relief relief = options.relief.value_or(Relief{}).in(grid);
  const double least = h.least - h.sea_level, most = h.most - h.sea_level;
  const double shore = std::min(grid.step, most / 2);  // vertices of a flat sea are on the grid, too
  const auto number = [&](const char* name, double value) {
    gl_.Uniform1f(program.uniform(name), static_cast<float>(value));
  };
  cuesta::set_uniforms(gl_, program, relief_uniforms(relief, (view.eye - grid.origin) / grid.step));
  number("unit", grid.step);
  number("shore", std::max(shore, 0.0));
  number("sea_level", h.sea_level);
  number("sea_floor", std::min(least, 0.0));
  number("land_least", std::max(least, 0.0));
  number("land_most", std::max({most, least + 1, 1.0}));
  gl_.Uniform1i(program.uniform("vertex_colours"), h.vertex_colours ? 1 : 0);
}

/// Depths of objects with different grids must compare: their near planes are at one place of the world.
CameraMatrices camera_of(std::span<const DrawList> lists, std::size_t object, const View& view) {
  double finest = lists[object].grid.step;
  for (const DrawList& list : lists) finest = std::min(finest, list.grid.step);
  CameraMatrices camera = camera_matrices(view, lists[object].grid);
  camera.near_units *= static_cast<float>(finest / lists[object].grid.step);
  return camera;
}

void GlRenderer::upload(std::span<const DrawList> lists) {
  objects_.resize(lists.size());
  uploads_ = {};
  for (std::size_t i = 0; i < lists.size(); ++i) {
    if (!objects_[i]) objects_[i] = std::make_unique<GpuObject>(gl_);
    uploads_ = uploads_ + objects_[i]->upload(lists[i]);
  }
}

void GlRenderer::draw_objects(std::span<const DrawList> lists, const View& view, const DrawOptions& options) {
  const GlProgram& program = *programs_[static_cast<std::size_t>(options.shading)];
  for (std::size_t i = 0; i < lists.size(); ++i) {
    set_uniforms(program, camera_of(lists, i, view), options);
    set_relief(program, lists[i].grid, view, options);
    if (options.shading == Shading::pages) {
      objects_[i]->draw_pages(lists[i], program.uniform("page"), 0);
    } else if (options.shading == Shading::changes) {
      uploads_ = uploads_ + objects_[i]->upload_tags(lists[i], program);
      objects_[i]->draw_tagged(program.uniform("first_triangle"));
    } else {
      objects_[i]->draw();
    }
  }
}

void GlRenderer::draw_page_numbers(std::span<const DrawList> lists, const View& view,
                                   const DrawOptions& options) {
  constexpr GLint pages_of_an_object = 1 << 22;  // numbers of objects that share one would only hide a line
  for (std::size_t i = 0; i < lists.size(); ++i) {
    set_uniforms(borders_.numbers(), camera_of(lists, i, view), options);
    set_relief(borders_.numbers(), lists[i].grid, view, options);
    objects_[i]->draw_pages(lists[i], borders_.numbers().uniform("page"),
                            static_cast<GLint>(i % 256) * pages_of_an_object);
  }
}

Result<void> GlRenderer::draw(std::span<const DrawList> lists, const View& view, const DrawOptions& options) {
  if (!context_->make_current()) return not_current();
  upload(lists);
  const auto begun = target_.begin(view.width_px, view.height_px, options.antialias ? antialias_samples : 1);
  if (!begun) return begun;
  clear_picture(gl_, options);
  draw_objects(lists, view, options);
  target_.end();
  if (options.page_borders) {
    if (auto r = borders_.begin(view.width_px, view.height_px); !r) return r;
    draw_page_numbers(lists, view, options);
    borders_.draw_onto(target_.picture());
  }
  return check_gl_errors(gl_, "drawing");
}

Result<Picture> GlRenderer::read() {
  if (!context_->make_current()) return not_current();
  return read_drawn(gl_, target_);
}

Result<void> GlRenderer::show(int width_px, int height_px, std::span<const TextBlock> text, int text_scale) {
  if (!context_->make_current()) return not_current();
  return show_drawn(gl_, target_, text_, width_px, height_px, text, text_scale);
}

}  // namespace

Result<std::unique_ptr<Renderer>> Renderer::create(std::unique_ptr<GlContext> context) {
  return create_renderer<Renderer, GlRenderer>(std::move(context));
}

}  // namespace cuesta
