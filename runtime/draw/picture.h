#pragma once
/// The plain picture that drawing, PNG files and comparisons exchange.

#include <vector>

#include "ooc/surface_mesh.h"

namespace cuesta {

/// 8-bit RGBA, sRGB, straight alpha, rows from the top: pixel (x, y) is pixels[y · width_px + x]. 4 bytes per
/// pixel.
struct Picture {
  int width_px = 0;
  int height_px = 0;
  std::vector<Rgba8> pixels;  ///< width_px · height_px
};

}  // namespace cuesta
