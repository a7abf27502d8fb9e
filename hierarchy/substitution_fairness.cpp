#include "hierarchy/substitution_fairness.h"

#include <algorithm>
#include <cmath>

#include "hierarchy/vector_clones.h"

namespace cuesta {
namespace {

using Side = MemorylessFairness::Side;
using Change = MemorylessFairness::Change;

/// Adds what each target makes of each triangle; nothing where the triangle goes.
/// @param count  lanes in use, known at run time only: so the inner loop becomes vector instructions
CUESTA_VECTOR_CLONES
void add_sides(std::span<const Side> sides, std::size_t count, Change& change) {
  Change& __restrict c = change;
  for (const Side& s : sides)
    for (std::size_t k = 0; k < count; ++k) {
      const float x = c.x[k], y = c.y[k], z = c.z[k];
      const float ax = s.from.x - x, ay = s.from.y - y, az = s.from.z - z;
      const float bx = s.to.x - x, by = s.to.y - y, bz = s.to.z - z;
      const float nx = ay * bz - az * by, ny = az * bx - ax * bz, nz = ax * by - ay * bx;
      const float stays = (s.a == c.target[k]) | (s.b == c.target[k]) ? 0.0f : 1.0f;
      const float size = stays * std::sqrt(nx * nx + ny * ny + nz * nz);
      c.volume[k] += stays * std::abs(s.normal.x * x + s.normal.y * y + s.normal.z * z);
      c.area[k] += size;
      c.turned[k] += s.normal.x * nx + s.normal.y * ny + s.normal.z * nz < 0 ? size : 0.0f;
      c.normal_x[k] += stays * nx;
      c.normal_y[k] += stays * ny;
      c.normal_z[k] += stays * nz;
    }
}

}  // namespace

MemorylessFairness::Around MemorylessFairness::collect_sides(PointId u) {
  const auto at = kernel_.positions();
  const Vec3f pu = at[u];
  sides_.clear();
  Around around{{}, 0};
  for (const TriangleId t : kernel_.star(u)) {
    const auto& c = kernel_.corners(t);
    const PointId a = c[0] == u ? c[1] : c[1] == u ? c[2] : c[0];
    const PointId b = c[0] == u ? c[2] : c[1] == u ? c[0] : c[1];
    const Vec3f from = at[a] - pu, to = at[b] - pu, normal = cross(from, to);
    sides_.push_back({a, b, from, to, normal});
    around.normal = around.normal + normal;
    around.area += length(normal);
  }
  around.normal = normalized(around.normal);
  return around;
}

void MemorylessFairness::costs(PointId u, std::span<const PointId> targets, std::span<float> out) {
  const Around before = collect_sides(u);
  const auto at = kernel_.positions();
  const float area = kernel_.on_border(u) ? border_area_weight : area_weight;
  for (std::size_t first = 0; first < targets.size(); first += lanes) {
    const std::size_t count = std::min(lanes, targets.size() - first);
    Change c{};
    for (std::size_t k = 0; k < count; ++k) {
      const Vec3f way = at[targets[first + k]] - at[u];
      c.target[k] = targets[first + k];
      c.x[k] = way.x;
      c.y[k] = way.y;
      c.z[k] = way.z;
    }
    add_sides(sides_, lanes, c);
    for (std::size_t k = 0; k < count; ++k) {
      const float l = length(Vec3f{c.x[k], c.y[k], c.z[k]});
      const Vec3f normal = normalized(Vec3f{c.normal_x[k], c.normal_y[k], c.normal_z[k]});
      const float turn = 1 - std::min(1.0f, dot(before.normal, normal));
      out[first + k] = c.volume[k] / 6 + l * (area / 2 * std::abs(c.area[k] - before.area) +
                                              inversion_weight * c.turned[k] + normal_weight * l * l * turn);
    }
  }
}

}  // namespace cuesta
