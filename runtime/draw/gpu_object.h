#pragma once
/// The GPU's copy of one draw list, and how it is drawn.

#include <vector>

#include "runtime/draw/gl_pool.h"
#include "runtime/draw/gl_program.h"

namespace cuesta {

/// Owns buffers of the pools' sizes. The functions and the context must outlive it.
class GpuObject {
 public:
  explicit GpuObject(const GlFunctions& gl);
  GpuObject(const GpuObject&) = delete;
  GpuObject& operator=(const GpuObject&) = delete;
  ~GpuObject();

  /// What the list says has changed.
  UploadCount upload(const DrawList& list);
  /// The tags of the triangles that are drawn; binds them to texture unit 0, for Shading::changes.
  UploadCount upload_tags(const DrawList& list, const GlProgram& program);

  /// All ranges in one call.
  void draw() const;
  /// A call for each range, after setting `uniform`: to its page plus `offset` (its place among the ranges if
  /// the list has no pages), or to its first triangle.
  void draw_pages(const DrawList& list, GLint uniform, GLint offset) const;
  void draw_tagged(GLint uniform) const;

 private:
  void describe_vertices();
  void set_ranges(const DrawList& list);
  UploadCount upload_morphed(const DrawList& list);

  const GlFunctions& gl_;
  GLuint vertex_array_ = 0, tag_texture_ = 0;
  GlPool vertices_, indices_, tags_;
  // The draw ranges in the form of glMultiDrawElements.
  std::vector<GLsizei> counts_;
  std::vector<const void*> offsets_;
  std::vector<MorphedVertex> morphed_;  ///< of this frame, by slot
  std::vector<Range> morphed_slots_;
  std::vector<DrawVertex> staging_;
};

}  // namespace cuesta
