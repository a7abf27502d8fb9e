#pragma once
/// A TOM's vertices in the form in which they are drawn.

#include "hierarchy/tom.h"
#include "ooc/grid.h"
#include "runtime/draw_list.h"

namespace cuesta {

/// The grid of vertex_of()'s positions.
inline Grid grid_of(const Tom& tom) {
  return {tom.origin, tom.step};
}
DrawVertex vertex_of(const Tom& tom, std::size_t v);

}  // namespace cuesta
