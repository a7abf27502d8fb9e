#include "runtime/draw/gl_pool.h"

#include <algorithm>

#include "ooc/check.h"
#include "runtime/draw/upload_ranges.h"

namespace cuesta {

void GlPool::grow(std::size_t pool_bytes) {
  const std::size_t capacity = std::max(pool_bytes, capacity_bytes_ + capacity_bytes_ / 2);
  GLuint larger = 0;
  gl_.GenBuffers(1, &larger);
  gl_.BindBuffer(GL_COPY_WRITE_BUFFER, larger);
  gl_.BufferData(GL_COPY_WRITE_BUFFER, static_cast<GLsizeiptr>(capacity), nullptr, GL_DYNAMIC_DRAW);
  if (filled_bytes_ > 0) {
    gl_.BindBuffer(GL_COPY_READ_BUFFER, id_);
    gl_.CopyBufferSubData(GL_COPY_READ_BUFFER, GL_COPY_WRITE_BUFFER, 0, 0,
                          static_cast<GLsizeiptr>(filled_bytes_));
  }
  gl_.DeleteBuffers(1, &id_);
  id_ = larger;
  capacity_bytes_ = capacity;
}

UploadCount GlPool::send(std::span<const std::byte> pool, std::size_t first, std::size_t bytes) {
  if (bytes == 0) return {};
  gl_.BufferSubData(target_, static_cast<GLintptr>(first), static_cast<GLsizeiptr>(bytes),
                    pool.data() + first);
  return {bytes, 1};
}

UploadCount GlPool::upload(std::span<const std::byte> pool, std::size_t element_bytes,
                           std::span<const Range> changed, bool& moved) {
  moved = pool.size() > capacity_bytes_;
  const bool first = filled_bytes_ == 0;
  if (moved) grow(pool.size());
  bind();
  filled_bytes_ = std::max(filled_bytes_, pool.size());
  if (first) return send(pool, 0, pool.size());
  UploadCount sent;
  for (const Range& range :
       coalesce(changed, static_cast<std::uint32_t>(gap_bytes / element_bytes), most_calls)) {
    const std::size_t begin = range.first * element_bytes, size = range.count * element_bytes;
    CUESTA_CHECK(begin + size <= pool.size(), range.first, range.count, pool.size() / element_bytes);
    sent = sent + send(pool, begin, size);
  }
  return sent;
}

}  // namespace cuesta
