#include "hierarchy/vertical_deviation.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "hierarchy/vector_clones.h"

namespace cuesta {
namespace {

constexpr std::size_t point_block = 8;

std::size_t padded(std::size_t n) {
  return (n + point_block - 1) / point_block * point_block;
}

/// Distances of the corners from the edges across, seen from above: what barycentric coordinates are shares
/// of.
struct Altitudes {
  float a, b, c;
};
Altitudes altitudes(const UprightTriangle& t, Vec3f up) {
  const Vec3f ab = t.corners[1] - t.corners[0], ac = t.corners[2] - t.corners[0];
  const float twice_area = dot(up, t.normal) * t.twice_area;
  return {twice_area / length(cross(up, ac - ab)), twice_area / length(cross(up, ac)),
          twice_area / length(cross(up, ab))};
}

/// Where a vertical passes a triangle a little outside, the plane goes on above or below it, but the triangle
/// ends: so much is added to the distance from the plane for each step outside.
struct Overhang {
  explicit Overhang(const UprightTriangle& t)
      : per_step(1 / t.uprightness), rounding(std::sqrt(t.longest_squared) * 0x1p-20f) {}
  float per_step, rounding;  // what is no farther outside than f32 may say is on the edge
};

/// One up for all: distances from edges and heights are linear in the point.
CUESTA_VECTOR_CLONES
void measure_on_plane(const UprightTriangle& t, Vec3f up, std::int32_t index, const VerticalPoints& points) {
  const Vec3f a = t.corners[0], ab = t.corners[1] - a, ac = t.corners[2] - a;
  const float upright = dot(up, t.normal), inv = 1.0f / (upright * t.twice_area);
  const Altitudes alt = altitudes(t, up);
  // Each by a vector of its own: of a needle, two distances do not tell the third in f32.
  const Vec3f to_a = cross(up, ac - ab) * (inv * alt.a), to_b = cross(ac, up) * (inv * alt.b),
              to_c = cross(up, ab) * (inv * alt.c), to_h = t.normal * (1.0f / upright);
  const Overhang overhang(t);
  const std::size_t n = padded(points.count);
  const float* __restrict x = points.x, * __restrict y = points.y, * __restrict z = points.z;
  float* __restrict inside = points.inside, * __restrict squared = points.squared;
  std::int32_t* __restrict nearest = points.nearest;
  for (std::size_t i = 0; i < n; ++i) {
    const float qx = x[i] - a.x, qy = y[i] - a.y, qz = z[i] - a.z;
    const float b = qx * to_b.x + qy * to_b.y + qz * to_b.z;
    const float c = qx * to_c.x + qy * to_c.y + qz * to_c.z;
    const float h = qx * to_h.x + qy * to_h.y + qz * to_h.z;
    const float from_a = alt.a + (qx * to_a.x + qy * to_a.y + qz * to_a.z);
    const float least = std::min(std::min(b, c), from_a);
    const bool better = least > inside[i];
    const float d = std::abs(h) + std::max(0.0f, -least - overhang.rounding) * overhang.per_step;
    squared[i] = better ? d * d : squared[i];
    nearest[i] = better ? index : nearest[i];
    inside[i] = better ? least : inside[i];
  }
}

CUESTA_VECTOR_CLONES
void measure_on_ellipsoid(const UprightTriangle& t, Vec3f up_at_a, std::int32_t index,
                          const VerticalPoints& points) {
  const Vec3f a = t.corners[0], ab = t.corners[1] - a, ac = t.corners[2] - a, bc = ac - ab, n = t.normal;
  // The up at a corner stands for all: what little they differ changes no sign.
  const Altitudes alt = altitudes(t, up_at_a);
  const float per_twice_area = 1.0f / t.twice_area;
  const Overhang overhang(t);
  const std::size_t count = padded(points.count);
  const float* __restrict x = points.x, * __restrict y = points.y, * __restrict z = points.z;
  const float* __restrict ux = points.up_x, * __restrict uy = points.up_y, * __restrict uz = points.up_z;
  float* __restrict inside = points.inside, * __restrict squared = points.squared;
  std::int32_t* __restrict nearest = points.nearest;
  for (std::size_t i = 0; i < count; ++i) {
    const float qx = x[i] - a.x, qy = y[i] - a.y, qz = z[i] - a.z;
    const float upright = ux[i] * n.x + uy[i] * n.y + uz[i] * n.z;
    // q × up, of which both coordinates are products.
    const float mx = qy * uz[i] - qz * uy[i], my = qz * ux[i] - qx * uz[i], mz = qx * uy[i] - qy * ux[i];
    const float inv = per_twice_area / upright;
    const float b = -(mx * ac.x + my * ac.y + mz * ac.z) * inv;
    const float c = (mx * ab.x + my * ab.y + mz * ab.z) * inv;
    const float h = (qx * n.x + qy * n.y + qz * n.z) * (inv * t.twice_area);
    const float per_up = ux[i] * ux[i] + uy[i] * uy[i] + uz[i] * uz[i];
    const float from_a = 1.0f + (mx * bc.x + my * bc.y + mz * bc.z) * inv;
    const float least = upright > 0 ? std::min(std::min(b * alt.b, c * alt.c), from_a * alt.a) : -1e30f;
    const bool better = least > inside[i];
    const float d =
        std::abs(h) * std::sqrt(per_up) + std::max(0.0f, -least - overhang.rounding) * overhang.per_step;
    squared[i] = better ? d * d : squared[i];
    nearest[i] = better ? index : nearest[i];
    inside[i] = better ? least : inside[i];
  }
}

}  // namespace

UprightTriangle upright(const std::array<Vec3f, 3>& corners, const LocalVertical& vertical) {
  UprightTriangle t;
  t.corners = corners;
  const Vec3d a = vec_cast<double>(corners[0]), b = vec_cast<double>(corners[1]),
              c = vec_cast<double>(corners[2]);
  const Vec3d n = cross(b - a, c - a);
  const double twice_area = length(n);
  t.longest_squared = static_cast<float>(std::max({dot(b - a, b - a), dot(c - b, c - b), dot(a - c, a - c)}));
  if (!(twice_area > 0)) return t;
  t.normal = vec_cast<float>(n / twice_area);
  t.twice_area = static_cast<float>(twice_area);
  t.uprightness = 1;
  for (const Vec3f& p : corners) t.uprightness = std::min(t.uprightness, dot(t.normal, vertical.up(p)));
  return t;
}

void measure_vertical(const UprightTriangle& t, const LocalVertical& vertical, std::int32_t index,
                      const VerticalPoints& points) {
  if (!(t.uprightness > 0)) return;
  if (vertical.is_plane)
    measure_on_plane(t, vertical.up_at_origin, index, points);
  else
    measure_on_ellipsoid(t, vertical.up(t.corners[0]), index, points);
}

BesidePoint beside(const std::array<Vec3f, 3>& corners, Vec3f p, const LocalVertical& vertical) {
  const Vec3d up = normalized(vec_cast<double>(vertical.up(p)));
  const auto flattened = [&up](Vec3d v) { return v - up * dot(up, v); };
  BesidePoint nearest{std::numeric_limits<double>::max(), 0};
  for (std::size_t k = 0; k < 3; ++k) {
    const Vec3d from = vec_cast<double>(corners[k]) - vec_cast<double>(p);
    const Vec3d edge = vec_cast<double>(corners[(k + 1) % 3]) - vec_cast<double>(corners[k]);
    const Vec3d a = flattened(from), e = flattened(edge);
    const double squared = dot(e, e), share = squared > 0 ? std::clamp(-dot(a, e) / squared, 0.0, 1.0) : 0.0;
    const double off = length(a + e * share);
    if (off < nearest.off) nearest = {off, dot(from + edge * share, from + edge * share)};
  }
  return nearest;
}

}  // namespace cuesta
