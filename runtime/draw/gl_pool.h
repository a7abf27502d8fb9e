#pragma once
/// The GPU copy of a pool (vertices or indices) that changes a little per frame and sometimes grows.

#include <cstddef>
#include <span>

#include "runtime/draw/gl_functions.h"
#include "runtime/draw_list.h"

namespace cuesta {

/// Owns one buffer object; the functions and the context must outlive it. Capacity: below twice the largest
/// pool seen.
class GlPool {
 public:
  GlPool(const GlFunctions& gl, GLenum target) : gl_(gl), target_(target) { gl_.GenBuffers(1, &id_); }
  GlPool(const GlPool&) = delete;
  GlPool& operator=(const GlPool&) = delete;
  ~GlPool() { gl_.DeleteBuffers(1, &id_); }

  void bind() const { gl_.BindBuffer(target_, id_); }
  /// Uploads the changed ranges, or everything when the pool has outgrown the buffer. Leaves the buffer
  /// bound.
  /// @pre   each range lies in the pool.
  template <class Element>
  void upload(std::span<const Element> pool, std::span<const Range> changed) {
    upload(std::as_bytes(pool), sizeof(Element), changed);
  }
  /// One element that differs from the pool's.   @pre bound, uploaded.
  template <class Element>
  void put(std::uint32_t at, const Element& element) {
    gl_.BufferSubData(target_, static_cast<GLintptr>(at * sizeof(Element)), sizeof(Element), &element);
  }

 private:
  void upload(std::span<const std::byte> pool, std::size_t element_bytes, std::span<const Range> changed);

  const GlFunctions& gl_;
  GLenum target_;
  GLuint id_ = 0;
  std::size_t capacity_bytes_ = 0;
};

}  // namespace cuesta
