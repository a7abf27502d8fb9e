#pragma once
/// What the vertex shader needs to know heights and up at a vertex, and to exaggerate heights.
///
/// Of a vertex at d from the eye, grid units, the shader computes |q|² - 1 as `excess` + 2 `eye`·s + s·s with
/// s = `to_radii` d: the small difference of large numbers is made here, in f64. What the shader rounds is
/// 2^-22 of the distance from the eye, as for positions (camera_matrices.h).

#include <array>

#include "runtime/draw/gl_program.h"
#include "runtime/relief.h"

namespace cuesta {

struct ReliefUniforms {
  int kind = 0;                     ///< 0: none, 1: a plane, 2: an ellipsoid
  std::array<float, 9> to_radii{};  ///< ellipsoid: from grid units to radii along its axes; rows
  Vec3f eye{};                      ///< ellipsoid: in radii along its axes
  float excess = 0;                 ///< ellipsoid: eye² - 1
  float eye_height = 0;             ///< plane: grid units
  Vec3f up, north;                  ///< plane: both; ellipsoid: north is its pole
  float exaggeration = 1;
};

/// @param eye  grid units.   @param relief  in grid units.
ReliefUniforms relief_uniforms(const Relief& relief, Vec3d eye);
void set_uniforms(const GlFunctions& gl, const GlProgram& program, const ReliefUniforms& u);

}  // namespace cuesta
