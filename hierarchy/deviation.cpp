#include "hierarchy/deviation.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>
#include <utility>

#include "hierarchy/vector_clones.h"

namespace cuesta {
namespace {

/// Points per step; arrays of points are as long as a multiple of it.
constexpr std::size_t point_block = 8;
/// Triangles whose constants are computed together: the lanes of f64 in AVX2.
constexpr std::size_t triangle_block = 4;

/// Constants of up to four triangles. Directions come from f64: the normal of a needle would be lost to
/// cancellation in f32.
struct Planes {
  using Lanes = float[triangle_block];
  struct Vec {
    Lanes x, y, z;
    Vec3f operator[](std::size_t k) const { return {x[k], y[k], z[k]}; }
  };
  Vec a, b, c;
  Vec ab, bc, ca;
  Vec n;                    // unit, zero for a degenerate triangle
  Vec in_ab, in_bc, in_ca;  // unit, in the plane, positive outside
  Lanes inv_ab, inv_bc, inv_ca;
  Lanes flat;  // squared length of n: 0 for a degenerate triangle
  Lanes longest;
};

inline float inverse(float squared) {
  return squared > 0 ? 1.0f / squared : 0.0f;
}

/// Edge e of lane k: its direction in f32 and its outwards direction.
inline void set_edge(Planes::Vec& edge, Planes::Vec& outwards, float* inv, std::size_t k, Vec3f ef, Vec3d e,
                     Vec3d n) {
  edge.x[k] = ef.x;
  edge.y[k] = ef.y;
  edge.z[k] = ef.z;
  const Vec3f o = vec_cast<float>(normalized(cross(e, n)));
  outwards.x[k] = o.x;
  outwards.y[k] = o.y;
  outwards.z[k] = o.z;
  inv[k] = inverse(dot(ef, ef));
}

/// Fills all but the corners. One loop over lanes, which becomes vector instructions.
CUESTA_VECTOR_CLONES
void complete_planes(Planes& p) {
  for (std::size_t k = 0; k < triangle_block; ++k) {
    const Vec3f a{p.a.x[k], p.a.y[k], p.a.z[k]}, b{p.b.x[k], p.b.y[k], p.b.z[k]},
        c{p.c.x[k], p.c.y[k], p.c.z[k]};
    const Vec3d ab = vec_cast<double>(b) - vec_cast<double>(a);
    const Vec3d bc = vec_cast<double>(c) - vec_cast<double>(b);
    const Vec3d ca = vec_cast<double>(a) - vec_cast<double>(c);
    const Vec3d n = normalized(cross(ab, -ca));
    p.n.x[k] = static_cast<float>(n.x);
    p.n.y[k] = static_cast<float>(n.y);
    p.n.z[k] = static_cast<float>(n.z);
    p.flat[k] = static_cast<float>(dot(n, n));
    set_edge(p.ab, p.in_ab, p.inv_ab, k, b - a, ab, n);
    set_edge(p.bc, p.in_bc, p.inv_bc, k, c - b, bc, n);
    set_edge(p.ca, p.in_ca, p.inv_ca, k, a - c, ca, n);
    const float lab = dot(b - a, b - a), lbc = dot(c - b, c - b), lca = dot(a - c, a - c);
    const float l = lab > lbc ? lab : lbc;
    p.longest[k] = l > lca ? l : lca;
  }
}

inline float clamp01(float t) {
  t = t > 0.0f ? t : 0.0f;
  return t < 1.0f ? t : 1.0f;
}

inline float to_segment(float px, float py, float pz, Vec3f e, float inv) {
  const float t = clamp01((px * e.x + py * e.y + pz * e.z) * inv);
  const float dx = px - t * e.x;
  const float dy = py - t * e.y;
  const float dz = pz - t * e.z;
  return dx * dx + dy * dy + dz * dz;
}

/// @param n  a multiple of point_block
CUESTA_VECTOR_CLONES
void measure_all(std::size_t n, const float* __restrict x, const float* __restrict y,
                 const float* __restrict z, float* __restrict best, std::int32_t* __restrict nearest,
                 const Planes& planes, std::size_t k, std::int32_t index) {
  const Vec3f a = planes.a[k], b = planes.b[k], c = planes.c[k];
  const Vec3f ab = planes.ab[k], bc = planes.bc[k], ca = planes.ca[k];
  const Vec3f in_ab = planes.in_ab[k], in_bc = planes.in_bc[k], in_ca = planes.in_ca[k];
  const Vec3f normal = planes.n[k];
  const float inv_ab = planes.inv_ab[k], inv_bc = planes.inv_bc[k], inv_ca = planes.inv_ca[k];
  // A degenerate triangle has no inside.
  const float inside = planes.flat[k] > 0 ? 0.0f : -1.0f;
  n = n / point_block * point_block;
  for (std::size_t i = 0; i < n; ++i) {
    const float ax = x[i] - a.x, ay = y[i] - a.y, az = z[i] - a.z;
    const float bx = x[i] - b.x, by = y[i] - b.y, bz = z[i] - b.z;
    const float cx = x[i] - c.x, cy = y[i] - c.y, cz = z[i] - c.z;
    const float oab = ax * in_ab.x + ay * in_ab.y + az * in_ab.z;
    const float obc = bx * in_bc.x + by * in_bc.y + bz * in_bc.z;
    const float oca = cx * in_ca.x + cy * in_ca.y + cz * in_ca.z;
    const float outside = std::max(std::max(oab, obc), oca);
    const float h = ax * normal.x + ay * normal.y + az * normal.z;
    const float plane = h * h;
    const float dab = to_segment(ax, ay, az, ab, inv_ab);
    const float dbc = to_segment(bx, by, bz, bc, inv_bc);
    const float dca = to_segment(cx, cy, cz, ca, inv_ca);
    const float edge = std::min(std::min(dab, dbc), dca);
    const float d = outside <= inside ? plane : edge;
    nearest[i] = d < best[i] ? index : nearest[i];
    best[i] = d < best[i] ? d : best[i];
  }
}

/// The directions up at n points.
CUESTA_VECTOR_CLONES
void fill_ups(const LocalVertical& vertical, std::size_t n, std::array<const float*, 3> points,
              std::array<float*, 3> ups) {
  const auto [x, y, z] = points;
  float* __restrict ux = ups[0], * __restrict uy = ups[1], * __restrict uz = ups[2];
  const LocalVertical v = vertical;
  n = n / point_block * point_block;
  for (std::size_t i = 0; i < n; ++i) {
    const Vec3f up = v.up({x[i], y[i], z[i]});
    ux[i] = up.x;
    uy[i] = up.y;
    uz[i] = up.z;
  }
}

}  // namespace

void DeviationBatch::grow() {
  const std::size_t capacity = std::max<std::size_t>(64, x_.size() * 2);
  for (auto* v : {&x_, &y_, &z_, &best_}) v->resize(capacity);
  nearest_.resize(capacity);
  if (!vertical_) return;
  for (auto* v : {&up_x_, &up_y_, &up_z_, &inside_}) v->resize(capacity);
}

void DeviationBatch::measure(std::span<const std::array<Vec3f, 3>> triangles, std::int32_t first_index) {
  if (vertical_)
    measure_along_vertical(triangles, first_index);
  else
    measure_nearest(triangles, first_index);
}

void DeviationBatch::measure_nearest(std::span<const std::array<Vec3f, 3>> triangles,
                                     std::int32_t first_index) {
  const std::size_t padded = (size_ + point_block - 1) / point_block * point_block;
  if (!std::exchange(measured_, true)) {
    std::fill_n(best_.begin(), padded, std::numeric_limits<float>::max());
    std::fill_n(nearest_.begin(), padded, -1);
  }
  Planes planes;
  const auto set = [](Planes::Vec& v, std::size_t k, Vec3f p) {
    v.x[k] = p.x;
    v.y[k] = p.y;
    v.z[k] = p.z;
  };
  for (std::size_t first = 0; first < triangles.size(); first += triangle_block) {
    const std::size_t count = std::min(triangle_block, triangles.size() - first);
    for (std::size_t k = 0; k < triangle_block; ++k) {
      const auto& t = triangles[first + std::min(k, count - 1)];
      set(planes.a, k, t[0]);
      set(planes.b, k, t[1]);
      set(planes.c, k, t[2]);
    }
    complete_planes(planes);
    for (std::size_t k = 0; k < count; ++k) {
      rounding_ = std::max(rounding_, std::sqrt(planes.longest[k]) * rounding_per_length);
      measure_all(padded, x_.data(), y_.data(), z_.data(), best_.data(), nearest_.data(), planes, k,
                  first_index + static_cast<std::int32_t>(first + k));
    }
  }
}

void DeviationBatch::measure_along_vertical(std::span<const std::array<Vec3f, 3>> triangles,
                                            std::int32_t first_index) {
  const std::size_t padded = (size_ + point_block - 1) / point_block * point_block;
  std::fill_n(inside_.begin(), padded, -std::numeric_limits<float>::max());
  if (!vertical_->is_plane)
    fill_ups(*vertical_, padded, {x_.data(), y_.data(), z_.data()},
             {up_x_.data(), up_y_.data(), up_z_.data()});
  const VerticalPoints points{size_,        x_.data(),    y_.data(),      z_.data(),    up_x_.data(),
                              up_y_.data(), up_z_.data(), inside_.data(), best_.data(), nearest_.data()};
  bool any_upright = false;
  for (std::size_t k = 0; k < triangles.size(); ++k) {
    const UprightTriangle t = upright(triangles[k], *vertical_);
    if (!(t.uprightness > 0)) continue;
    any_upright = true;
    rounding_ = std::max(rounding_, std::sqrt(t.longest_squared) * rounding_per_length / t.uprightness);
    measure_vertical(t, *vertical_, first_index + static_cast<std::int32_t>(k), points);
  }
  if (!any_upright) return measure_nearest(triangles, first_index);
  const bool all_through = std::all_of(inside_.begin(), inside_.begin() + static_cast<std::ptrdiff_t>(size_),
                                       [](float inside) { return inside >= inside_rounding; });
  if (!all_through) measure_beside(triangles, first_index);
}

/// Of points whose verticals go through none. Few: what is said about them is exact rather than fast.
void DeviationBatch::measure_beside(std::span<const std::array<Vec3f, 3>> triangles,
                                    std::int32_t first_index) {
  for (std::size_t i = 0; i < size_; ++i) {
    if (inside_[i] >= inside_rounding) continue;
    double least_off = std::numeric_limits<double>::max();
    for (std::size_t k = 0; k < triangles.size(); ++k) {
      if (!(upright(triangles[k], *vertical_).uprightness > 0)) continue;
      const BesidePoint at = beside(triangles[k], point(i), *vertical_);
      if (!(at.off < least_off)) continue;
      least_off = at.off;
      best_[i] = static_cast<float>(at.squared_distance);
      nearest_[i] = first_index + static_cast<std::int32_t>(k);
    }
  }
}

float DeviationBatch::bound_of(float squared) const {
  if (squared == 0 && rounding_ < negligible) return 0;
  return std::sqrt(squared) * (1 + relative_rounding) + rounding_;
}

float DeviationBatch::worst_bound() const {
  // Squares are not negative: their bits are in order, and a maximum of integers becomes vector instructions.
  std::int32_t most = 0;
  for (std::size_t i = 0; i < size_; ++i) most = std::max(most, std::bit_cast<std::int32_t>(best_[i]));
  return bound_of(std::bit_cast<float>(most));
}

}  // namespace cuesta
