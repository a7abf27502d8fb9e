#pragma once
/// The GPU copy of a pool (vertices or indices) that changes a little per frame and sometimes grows.

#include <cstddef>
#include <cstdint>
#include <span>

#include "runtime/draw/gl_functions.h"
#include "runtime/draw_list.h"

namespace cuesta {

/// What went to the GPU.
struct UploadCount {
  std::uint64_t bytes = 0;
  std::uint32_t calls = 0;

  friend UploadCount operator+(UploadCount a, UploadCount b) {
    return {a.bytes + b.bytes, a.calls + b.calls};
  }
};

/// Owns one buffer object; the functions and the context must outlive it. Capacity: at most 1.5 times the
/// largest pool seen, and both the old and the new buffer for a moment when it grows.
class GlPool {
 public:
  static constexpr std::size_t most_calls = 512;  ///< of one upload
  static constexpr std::size_t gap_bytes = 2048;  ///< smaller gaps are uploaded rather than left out

  GlPool(const GlFunctions& gl, GLenum target) : gl_(gl), target_(target) { gl_.GenBuffers(1, &id_); }
  GlPool(const GlPool&) = delete;
  GlPool& operator=(const GlPool&) = delete;
  ~GlPool() { gl_.DeleteBuffers(1, &id_); }

  GLuint id() const { return id_; }
  void bind() const { gl_.BindBuffer(target_, id_); }
  /// Uploads the first pool whole, and of later ones what has changed; a buffer that must grow is copied by
  /// the GPU. Leaves the buffer bound. Sets `moved` if the buffer object is another one: what refers to it
  /// must be set again.
  /// @pre   each range lies in the pool.
  template <class Element>
  UploadCount upload(std::span<const Element> pool, std::span<const Range> changed, bool& moved) {
    return upload(std::as_bytes(pool), sizeof(Element), changed, moved);
  }
  /// Elements from `first` on that differ from the pool's, until they are uploaded again.
  /// @pre   bound, and large enough.
  template <class Element>
  UploadCount put(std::uint32_t first, std::span<const Element> elements) {
    gl_.BufferSubData(target_, static_cast<GLintptr>(first * sizeof(Element)),
                      static_cast<GLsizeiptr>(elements.size_bytes()), elements.data());
    return {elements.size_bytes(), 1};
  }

 private:
  UploadCount upload(std::span<const std::byte> pool, std::size_t element_bytes,
                     std::span<const Range> changed, bool& moved);
  void grow(std::size_t pool_bytes);
  UploadCount send(std::span<const std::byte> pool, std::size_t first, std::size_t bytes);

  const GlFunctions& gl_;
  GLenum target_;
  GLuint id_ = 0;
  std::size_t capacity_bytes_ = 0;
  std::size_t filled_bytes_ = 0;  ///< of the largest pool so far
};

}  // namespace cuesta
