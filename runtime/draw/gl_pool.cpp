#include "runtime/draw/gl_pool.h"

#include <algorithm>

#include "ooc/check.h"

namespace cuesta {

void GlPool::upload(std::span<const std::byte> pool, std::size_t element_bytes,
                    std::span<const Range> changed) {
  bind();
  if (pool.size() > capacity_bytes_) {
    capacity_bytes_ = capacity_bytes_ == 0 ? pool.size() : std::max(pool.size(), 2 * capacity_bytes_);
    gl_.BufferData(target_, static_cast<GLsizeiptr>(capacity_bytes_), nullptr, GL_DYNAMIC_DRAW);
    gl_.BufferSubData(target_, 0, static_cast<GLsizeiptr>(pool.size()), pool.data());
    return;
  }
  for (const Range& range : changed) {
    const std::size_t first = range.first * element_bytes;
    const std::size_t size = range.count * element_bytes;
    CUESTA_CHECK(first + size <= pool.size(), range.first, range.count, pool.size() / element_bytes);
    if (size == 0) continue;
    gl_.BufferSubData(target_, static_cast<GLintptr>(first), static_cast<GLsizeiptr>(size),
                      pool.data() + first);
  }
}

}  // namespace cuesta
