#include "runtime/draw/gpu_object.h"

#include <algorithm>
#include <cstddef>
#include <limits>

#include "ooc/check.h"
#include "runtime/draw/surface_shaders.h"
#include "runtime/draw/upload_ranges.h"

namespace cuesta {

GpuObject::GpuObject(const GlFunctions& gl)
    : gl_(gl),
      vertices_(gl, GL_ARRAY_BUFFER),
      indices_(gl, GL_ELEMENT_ARRAY_BUFFER),
      tags_(gl, GL_TEXTURE_BUFFER) {
  gl_.GenVertexArrays(1, &vertex_array_);
}

GpuObject::~GpuObject() {
  gl_.DeleteVertexArrays(1, &vertex_array_);
  gl_.DeleteTextures(1, &tag_texture_);
}

void GpuObject::describe_vertices() {
  const auto offset = [](std::size_t bytes) { return reinterpret_cast<const void*>(bytes); };
  constexpr GLsizei stride = sizeof(DrawVertex);
  vertices_.bind();
  gl_.VertexAttribIPointer(position_attribute, 3, GL_INT, stride, offset(offsetof(DrawVertex, x)));
  gl_.VertexAttribIPointer(normal_attribute, 2, GL_SHORT, stride, offset(offsetof(DrawVertex, normal_u)));
  gl_.VertexAttribPointer(colour_attribute, 4, GL_UNSIGNED_BYTE, GL_TRUE, stride,
                          offset(offsetof(DrawVertex, colour)));
  for (const GLuint attribute : {position_attribute, normal_attribute, colour_attribute})
    gl_.EnableVertexAttribArray(attribute);
}

void GpuObject::set_ranges(const DrawList& list) {
  counts_.clear();
  offsets_.clear();
  for (const Range& range : list.draws) {
    CUESTA_CHECK(std::uint64_t{range.first} + range.count <= list.indices.size(), range.first, range.count);
    CUESTA_CHECK(range.count <= static_cast<std::uint32_t>(std::numeric_limits<GLsizei>::max()), range.count);
    counts_.push_back(static_cast<GLsizei>(range.count));
    offsets_.push_back(reinterpret_cast<const void*>(std::uintptr_t{range.first} * sizeof(std::uint32_t)));
  }
}

/// Pieces of the pool with the morphed vertices in their places: as few calls as for changes.
UploadCount GpuObject::upload_morphed(const DrawList& list) {
  morphed_.assign(list.morphed.begin(), list.morphed.end());
  std::sort(morphed_.begin(), morphed_.end(),
            [](const MorphedVertex& a, const MorphedVertex& b) { return a.slot < b.slot; });
  morphed_slots_.clear();
  for (const MorphedVertex& m : morphed_) morphed_slots_.push_back({m.slot, 1});
  UploadCount sent;
  auto next = morphed_.begin();
  for (const Range& piece :
       coalesce(morphed_slots_, GlPool::gap_bytes / sizeof(DrawVertex), GlPool::most_calls)) {
    CUESTA_CHECK(std::uint64_t{piece.first} + piece.count <= list.vertices.size(), piece.first, piece.count);
    const auto pool = list.vertices.subspan(piece.first, piece.count);
    staging_.assign(pool.begin(), pool.end());
    for (; next != morphed_.end() && next->slot - piece.first < piece.count; ++next)
      staging_[next->slot - piece.first] = next->vertex;
    sent = sent + vertices_.put(piece.first, std::span<const DrawVertex>(staging_));
  }
  return sent;
}

UploadCount GpuObject::upload(const DrawList& list) {
  bool moved = false;
  gl_.BindVertexArray(vertex_array_);
  UploadCount sent = vertices_.upload(list.vertices, list.changed_vertices, moved);
  if (moved) describe_vertices();
  sent = sent + upload_morphed(list);
  sent = sent + indices_.upload(list.indices, list.changed_indices, moved);
  set_ranges(list);
  return sent;
}

UploadCount GpuObject::upload_tags(const DrawList& list, const GlProgram& program) {
  GLint most = 0;
  gl_.GetIntegerv(GL_MAX_TEXTURE_BUFFER_SIZE, &most);  // the rest counts as unchanged
  const auto tags =
      list.triangle_tags.first(std::min(list.triangle_tags.size(), static_cast<std::size_t>(most)));
  std::vector<Range> drawn;
  for (const Range& range : list.draws) {
    const std::size_t first = range.first / 3,
                      end = std::min<std::size_t>(first + range.count / 3, tags.size());
    if (first < end)
      drawn.push_back({static_cast<std::uint32_t>(first), static_cast<std::uint32_t>(end - first)});
  }
  UploadCount sent;
  gl_.ActiveTexture(GL_TEXTURE0);
  if (!tags.empty()) {
    bool moved = false;
    sent = tags_.upload(tags, drawn, moved);
    if (tag_texture_ == 0) gl_.GenTextures(1, &tag_texture_);
    gl_.BindTexture(GL_TEXTURE_BUFFER, tag_texture_);
    if (moved) gl_.TexBuffer(GL_TEXTURE_BUFFER, GL_R8UI, tags_.id());
  }
  gl_.Uniform1i(program.uniform("triangle_tags"), 0);
  gl_.Uniform1i(program.uniform("tag_count"), static_cast<GLint>(tags.size()));
  return sent;
}

void GpuObject::draw() const {
  if (counts_.empty()) return;
  gl_.BindVertexArray(vertex_array_);
  gl_.MultiDrawElements(GL_TRIANGLES, counts_.data(), GL_UNSIGNED_INT, offsets_.data(),
                        static_cast<GLsizei>(counts_.size()));
}

void GpuObject::draw_pages(const DrawList& list, GLint uniform, GLint offset) const {
  gl_.BindVertexArray(vertex_array_);
  const bool known = list.draw_pages.size() == counts_.size();
  for (std::size_t i = 0; i < counts_.size(); ++i) {
    gl_.Uniform1i(uniform, offset + static_cast<GLint>(known ? list.draw_pages[i] : i));
    gl_.DrawElements(GL_TRIANGLES, counts_[i], GL_UNSIGNED_INT, offsets_[i]);
  }
}

void GpuObject::draw_tagged(GLint uniform) const {
  gl_.BindVertexArray(vertex_array_);
  for (std::size_t i = 0; i < counts_.size(); ++i) {
    const std::size_t first_triangle =
        reinterpret_cast<std::uintptr_t>(offsets_[i]) / (3 * sizeof(std::uint32_t));
    gl_.Uniform1i(uniform, static_cast<GLint>(first_triangle));
    gl_.DrawElements(GL_TRIANGLES, counts_[i], GL_UNSIGNED_INT, offsets_[i]);
  }
}

}  // namespace cuesta
