#include "hierarchy/input_chunk.h"

#include <utility>

#include "hierarchy/page_order.h"

namespace cuesta {

Result<InputChunk> load_input_chunk(const InputSurface& surface, std::uint32_t c,
                                    std::uint32_t cell_triangles) {
  auto chunk = surface.chunk(c);
  if (!chunk) return fail(chunk.error());
  InputChunk out;
  static_cast<SurfaceChunk&>(out.chunk) = std::move(*chunk);
  out.cells = order_for_pages(out.chunk, cell_triangles);
  return out;
}

}  // namespace cuesta
