#include "hierarchy/quadric_cost.h"

#include <cmath>

namespace cuesta {
namespace {

/// Weight of the plane that stands on a border edge, against the area weights of the surface's own planes.
constexpr float border_weight = 2.0f;

}  // namespace

QuadricCost::QuadricCost(const SubstitutionKernel& kernel)
    : position_(kernel.positions()), is_mean_(kernel.is_field_of_heights()), movers_(kernel.point_count()) {
  for (TriangleId triangle = 0; triangle < kernel.triangle_count(); ++triangle) {
    const auto& t = kernel.corners(triangle);
    const Vec3f a = position_[t[0]], b = position_[t[1]], c = position_[t[2]];
    const Vec3f n = cross(b - a, c - a);
    const float twice_area = length(n);
    if (!(twice_area > 0)) continue;
    const Vec3f unit = n / twice_area;
    const float upright = is_mean_ ? dot(unit, kernel.vertical()->up(a)) : 1.0f;
    if (upright > least_uprightness)  // of heights: vertical distance, and the area seen from above
      for (int i = 0; i < 3; ++i) movers_[t[i]].quadric.add_plane(unit / upright, twice_area * upright);
    for (int i = 0; i < 3; ++i) {
      const PointId p = t[i], q = t[(i + 1) % 3];
      if (!kernel.on_border(p) || !kernel.on_border(q)) continue;
      if (kernel.edge_triangles(p, q) != 1) continue;
      const Vec3f e = position_[q] - position_[p];
      const Vec3f side = normalized(cross(e, unit));
      for (PointId end : {p, q}) movers_[end].quadric.add_plane(side, border_weight * dot(e, e));
    }
  }
  for (PointId p = 0; p < movers_.size(); ++p) {
    movers_[p].position = position_[p];
    set_divisor(p);
  }
}

void QuadricCost::set_divisor(PointId p) {
  const float weight = movers_[p].quadric.weight;
  movers_[p].divisor = is_mean_ ? weight : std::sqrt(weight);
}

}  // namespace cuesta
