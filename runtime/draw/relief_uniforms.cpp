#include "runtime/draw/relief_uniforms.h"

namespace cuesta {

ReliefUniforms relief_uniforms(const Relief& r, Vec3d eye) {
  ReliefUniforms u;
  u.exaggeration = static_cast<float>(r.exaggeration);
  u.north = vec_cast<float>(r.axes[r.is_plane() ? 1 : 2]);
  u.kind = r.is_plane() ? 1 : 2;
  if (r.is_plane()) {
    u.up = vec_cast<float>(r.axes[2]);
    u.eye_height = static_cast<float>(r.height(eye));
    return u;
  }
  const Vec3d radii{r.equatorial_radius, r.equatorial_radius, r.polar_radius};
  Vec3d q;
  for (int row = 0; row < 3; ++row) {
    const auto axis = r.axes[static_cast<std::size_t>(row)];
    q[row] = dot(eye - r.origin, axis) / radii[row];
    for (int column = 0; column < 3; ++column)
      u.to_radii[static_cast<std::size_t>(3 * row + column)] = static_cast<float>(axis[column] / radii[row]);
  }
  u.eye = vec_cast<float>(q);
  u.excess = static_cast<float>(dot(q, q) - 1);
  return u;
}

void set_uniforms(const GlFunctions& gl, const GlProgram& program, const ReliefUniforms& u) {
  const auto vector = [&](const char* name, Vec3f v) { gl.Uniform3f(program.uniform(name), v.x, v.y, v.z); };
  gl.Uniform1i(program.uniform("relief_kind"), u.kind);
  gl.UniformMatrix3fv(program.uniform("relief_to_radii"), 1, GL_TRUE, u.to_radii.data());
  vector("relief_eye", u.eye);
  vector("relief_up", u.up);
  vector("relief_north", u.north);
  gl.Uniform1f(program.uniform("relief_excess"), u.excess);
  gl.Uniform1f(program.uniform("relief_eye_height"), u.eye_height);
  gl.Uniform1f(program.uniform("exaggeration"), u.exaggeration);
}

}  // namespace cuesta
