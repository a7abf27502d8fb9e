#include "runtime/draw/scene_renderer.h"

#include <array>
#include <cmath>
#include <optional>
#include <unordered_map>
#include <vector>

#include "ooc/check.h"
#include "runtime/draw/camera_matrices.h"
#include "runtime/draw/frame_state.h"
#include "runtime/draw/frame_target.h"
#include "runtime/draw/gl_program.h"
#include "runtime/draw/gpu_object.h"
#include "runtime/draw/pixel_counts.h"
#include "runtime/draw/surface_shaders.h"
#include "runtime/draw/text_painter.h"
#include "runtime/draw/tom_vertices.h"

namespace cuesta {
namespace {

constexpr std::array shadings{Shading::lit, Shading::wireframe, Shading::normals};

/// What the shader reads of an instance: 64 bytes.
struct InstanceRow {
  std::array<std::array<float, 4>, 3> to_camera;
  std::array<float, 4> tint;
};
static_assert(sizeof(InstanceRow) == 64);

/// From grid units about the anchor to the camera's frame.
InstanceRow row_of(const DrawnInstance& instance, const Grid& grid, Vec3i anchor, const View& view,
                   const std::array<Vec3d, 3>& frame) {
  const Vec3d from_eye = instance.world.point(grid.world(anchor)) - view.eye;
  InstanceRow row;
  for (std::size_t i = 0; i < 3; ++i) {
    for (std::size_t k = 0; k < 3; ++k)
      row.to_camera[i][k] = static_cast<float>(dot(frame[i], instance.world.columns[k]) * grid.step);
    row.to_camera[i][3] = static_cast<float>(dot(frame[i], from_eye));
  }
  const Vec3f tint = linear_from_srgb(instance.colour);
  row.tint = {tint.x, tint.y, tint.z, 1};
  return row;
}

/// A part's vertices on the GPU, with the arrays that say how they are read.
class GpuPart {
 public:
  explicit GpuPart(const GlFunctions& gl) : gl_(gl) {
    gl_.GenVertexArrays(1, &array_);
    gl_.GenBuffers(1, &vertices_);
  }
  GpuPart(const GpuPart&) = delete;
  GpuPart& operator=(const GpuPart&) = delete;
  ~GpuPart() {
    gl_.DeleteBuffers(1, &vertices_);
    gl_.DeleteVertexArrays(1, &array_);
  }

  /// Uploads the part if it is another than the last.   @return bytes sent
  std::uint64_t upload(const std::shared_ptr<const Tom>& tom, std::vector<DrawVertex>& staging) {
    gl_.BindVertexArray(array_);
    if (tom == tom_) return 0;
    tom_ = tom;
    staging.clear();
    for (std::size_t v = 0; v < tom->positions.size(); ++v) staging.push_back(vertex_of(*tom, v));
    gl_.BindBuffer(GL_ARRAY_BUFFER, vertices_);
    const std::uint64_t bytes = staging.size() * sizeof(DrawVertex);
    gl_.BufferData(GL_ARRAY_BUFFER, static_cast<GLsizeiptr>(bytes), staging.data(), GL_STATIC_DRAW);
    describe();
    return bytes;
  }

  std::uint64_t used = 0;  ///< picture

 private:
  void describe() const {
    const auto offset = [](std::size_t bytes) { return reinterpret_cast<const void*>(bytes); };
    constexpr GLsizei stride = sizeof(DrawVertex);
    gl_.VertexAttribIPointer(position_attribute, 3, GL_INT, stride, offset(offsetof(DrawVertex, x)));
    gl_.VertexAttribIPointer(normal_attribute, 2, GL_SHORT, stride, offset(offsetof(DrawVertex, normal_u)));
    gl_.VertexAttribPointer(colour_attribute, 4, GL_UNSIGNED_BYTE, GL_TRUE, stride,
                            offset(offsetof(DrawVertex, colour)));
    for (GLuint a = position_attribute; a <= tint_attribute; ++a) gl_.EnableVertexAttribArray(a);
    for (GLuint a = first_row_attribute; a <= tint_attribute; ++a) gl_.VertexAttribDivisor(a, 1);
  }

  const GlFunctions& gl_;
  GLuint array_ = 0, vertices_ = 0;
  std::shared_ptr<const Tom> tom_;
};

struct GpuBlock {
  GLuint buffer = 0;
  std::uint64_t used = 0;  // picture
};

class GlSceneRenderer final : public SceneRenderer {
 public:
  GlSceneRenderer(std::unique_ptr<GlContext> context, const GlFunctions& gl);
  ~GlSceneRenderer() override;
  GlSceneRenderer(const GlSceneRenderer&) = delete;
  GlSceneRenderer& operator=(const GlSceneRenderer&) = delete;

  Result<void> compile();
  Result<void> draw(const SceneDrawList& list, const View& view, double nearest,
                    const DrawOptions& options) override;
  Result<Picture> read() override;
  Result<void> show(int width_px, int height_px, std::span<const TextBlock> text, int text_scale) override;
  void finish() override {
    if (context_->make_current()) gl_.Finish();
  }
  std::span<const CallFill> fill() override {
    return context_->make_current() ? counts_.read() : std::span<const CallFill>();
  }
  UploadReport uploads() const override { return uploads_; }
  const std::string& driver() const override { return driver_; }

 private:
  const GlProgram& use_program(const View& view, double nearest, const DrawOptions& options);
  void upload_instances(const SceneDrawList& list, const View& view);
  void draw_group(const DrawnGroup& group);
  void draw_surface(const DrawnSurface& surface, const View& view, GLint anchor);
  void bind_indices(const IndexBlock& block);
  void point_at_instances(std::uint32_t first);
  void forget_old();

  std::unique_ptr<GlContext> context_;
  GlFunctions gl_;
  std::string driver_;
  std::array<std::optional<GlProgram>, shadings.size()> programs_;
  FrameTarget target_;
  PixelCounts counts_;
  TextPainter text_;
  std::unordered_map<std::uint32_t, std::unique_ptr<GpuPart>> parts_;
  std::unordered_map<std::uint64_t, GpuBlock> blocks_;
  struct Surface {
    std::unique_ptr<GpuObject> object;
    std::uint64_t used = 0;
  };
  std::unordered_map<std::uint32_t, Surface> surfaces_;  // by instance
  GLuint instance_buffer_ = 0;
  std::vector<InstanceRow> rows_;
  std::vector<DrawVertex> staging_;
  std::uint64_t picture_ = 0;
  UploadReport uploads_;
};

GlSceneRenderer::GlSceneRenderer(std::unique_ptr<GlContext> context, const GlFunctions& gl)
    : context_(std::move(context)), gl_(gl), target_(gl_), counts_(gl_), text_(gl_) {
  gl_.GenBuffers(1, &instance_buffer_);
  const GLubyte* const name = gl_.GetString(GL_RENDERER);
  driver_ =
      std::string(context_->kind()) + ", " + (name ? reinterpret_cast<const char*>(name) : "unnamed driver");
}

GlSceneRenderer::~GlSceneRenderer() {
  context_->make_current();  // the members' destructors delete from it
  gl_.DeleteBuffers(1, &instance_buffer_);
  for (const auto& [id, block] : blocks_) gl_.DeleteBuffers(1, &block.buffer);
}

Result<void> GlSceneRenderer::compile() {
  for (std::size_t i = 0; i < shadings.size(); ++i) {
    auto program = GlProgram::link(gl_, instance_shaders(shadings[i], gl_.ClipControl == nullptr));
    if (!program) return fail(program.error());
    programs_[i].emplace(std::move(*program));
  }
  if (auto ok = text_.compile(); !ok) return ok;
  return check_gl_errors(gl_, "setting up");
}

const GlProgram& GlSceneRenderer::use_program(const View& view, double nearest, const DrawOptions& options) {
  std::size_t which = 0;
  while (which + 1 < shadings.size() && shadings[which] != options.shading) ++which;
  if (shadings[which] != options.shading) which = 0;
  const GlProgram& program = *programs_[which];
  const double focal = 1 / std::tan(view.fov_y_rad / 2);
  program.use();
  gl_.Uniform2f(program.uniform("focal"), static_cast<float>(focal * view.height_px / view.width_px),
                static_cast<float>(focal));
  gl_.Uniform1f(program.uniform("near_units"), static_cast<float>(nearest));
  set_lights(gl_, program, options);
  return program;
}

void GlSceneRenderer::upload_instances(const SceneDrawList& list, const View& view) {
  const auto frame = view.frame();
  rows_.resize(list.instances.size());
  for (const DrawnGroup& group : list.groups)
    for (std::uint32_t i = group.first; i < group.first + group.count; ++i)
      rows_[i] = row_of(list.instances[i], grid_of(*group.tom), {}, view, frame);
  gl_.BindBuffer(GL_ARRAY_BUFFER, instance_buffer_);
  const std::size_t bytes = rows_.size() * sizeof(InstanceRow);
  gl_.BufferData(GL_ARRAY_BUFFER, static_cast<GLsizeiptr>(bytes), rows_.data(), GL_STREAM_DRAW);
  uploads_.bytes += bytes, ++uploads_.calls;
}

/// @pre its vertex array is bound
void GlSceneRenderer::bind_indices(const IndexBlock& block) {
  GpuBlock& on_gpu = blocks_[block.id];
  on_gpu.used = picture_;
  const bool is_new = on_gpu.buffer == 0;
  if (is_new) gl_.GenBuffers(1, &on_gpu.buffer);
  gl_.BindBuffer(GL_ELEMENT_ARRAY_BUFFER, on_gpu.buffer);
  if (!is_new) return;
  const std::size_t bytes = block.triangles.size() * sizeof(Triangle);
  gl_.BufferData(GL_ELEMENT_ARRAY_BUFFER, static_cast<GLsizeiptr>(bytes), block.triangles.data(),
                 GL_STATIC_DRAW);
  uploads_.bytes += bytes, ++uploads_.calls;
}

void GlSceneRenderer::point_at_instances(std::uint32_t first) {
  gl_.BindBuffer(GL_ARRAY_BUFFER, instance_buffer_);
  for (GLuint i = 0; i < 4; ++i) {
    const std::size_t at = first * sizeof(InstanceRow) + i * sizeof(std::array<float, 4>);
    gl_.VertexAttribPointer(first_row_attribute + i, 4, GL_FLOAT, GL_FALSE, sizeof(InstanceRow),
                            reinterpret_cast<const void*>(at));
  }
}

void GlSceneRenderer::draw_group(const DrawnGroup& group) {
  if (group.indices->triangles.empty()) return;
  auto& part = parts_[group.part];
  if (!part) part = std::make_unique<GpuPart>(gl_);
  part->used = picture_;
  const std::uint64_t sent = part->upload(group.tom, staging_);
  uploads_.bytes += sent, uploads_.calls += sent > 0 ? 1 : 0;
  bind_indices(*group.indices);
  point_at_instances(group.first);
  gl_.FrontFace(group.mirrored ? GL_CW : GL_CCW);
  gl_.DrawElementsInstanced(GL_TRIANGLES, static_cast<GLsizei>(3 * group.indices->triangles.size()),
                            GL_UNSIGNED_INT, nullptr, static_cast<GLsizei>(group.count));
}

void GlSceneRenderer::draw_surface(const DrawnSurface& surface, const View& view, GLint anchor) {
  Surface& s = surfaces_[surface.as.instance];
  if (!s.object) s.object = std::make_unique<GpuObject>(gl_);
  s.used = picture_;
  const UploadCount sent = s.object->upload(surface.list);
  uploads_.bytes += sent.bytes, uploads_.calls += sent.calls;
  // The grid has up to 2^30 steps, more than a float tells apart: it is seen from near the eye.
  View within = view;
  within.eye = surface.eye;
  const Vec3i at = camera_matrices(within, surface.list.grid).eye_whole;
  gl_.Uniform3i(anchor, at.x, at.y, at.z);
  const InstanceRow row = row_of(surface.as, surface.list.grid, at, view, view.frame());
  for (GLuint i = 0; i < 3; ++i) gl_.VertexAttrib4fv(first_row_attribute + i, row.to_camera[i].data());
  gl_.VertexAttrib4fv(tint_attribute, row.tint.data());
  gl_.FrontFace(surface.mirrored ? GL_CW : GL_CCW);
  s.object->draw();
}

void GlSceneRenderer::forget_old() {
  const auto old = [this](std::uint64_t used) { return used + kept_frames < picture_; };
  std::erase_if(parts_, [&](const auto& p) { return old(p.second->used); });
  std::erase_if(surfaces_, [&](const auto& s) { return old(s.second.used); });
  std::erase_if(blocks_, [&](const auto& b) {
    if (old(b.second.used)) gl_.DeleteBuffers(1, &b.second.buffer);
    return old(b.second.used);
  });
}

Result<void> GlSceneRenderer::draw(const SceneDrawList& list, const View& view, double nearest,
                                   const DrawOptions& options) {
  CUESTA_CHECK(nearest > 0, nearest);
  if (!context_->make_current()) return not_current();
  ++picture_;
  uploads_ = {};
  const int samples = options.antialias ? antialias_samples : 1;
  if (auto begun = target_.begin(view.width_px, view.height_px, samples); !begun) return begun;
  counts_.begin_picture(target_.samples());
  clear_picture(gl_, options);
  const GLint anchor = use_program(view, nearest, options).uniform("anchor");
  gl_.Uniform3i(anchor, 0, 0, 0);
  upload_instances(list, view);
  for (const DrawnGroup& group : list.groups) {
    counts_.begin();
    draw_group(group);
    counts_.end();
  }
  for (const DrawnSurface& surface : list.surfaces) {
    counts_.begin();
    draw_surface(surface, view, anchor);
    counts_.end();
  }
  gl_.FrontFace(GL_CCW);
  target_.end();
  forget_old();
  return check_gl_errors(gl_, "drawing");
}

Result<Picture> GlSceneRenderer::read() {
  if (!context_->make_current()) return not_current();
  return read_drawn(gl_, target_);
}

Result<void> GlSceneRenderer::show(int width_px, int height_px, std::span<const TextBlock> text,
                                   int text_scale) {
  if (!context_->make_current()) return not_current();
  return show_drawn(gl_, target_, text_, width_px, height_px, text, text_scale);
}

}  // namespace

Result<std::unique_ptr<SceneRenderer>> SceneRenderer::create(std::unique_ptr<GlContext> context) {
  return create_renderer<SceneRenderer, GlSceneRenderer>(std::move(context));
}

}  // namespace cuesta
