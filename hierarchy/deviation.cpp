#include "hierarchy/deviation.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace cuesta {
namespace {

#if defined(__x86_64__) && !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__) && \
    !defined(__clang__)
// One source, two encodings, the same IEEE operations: the result does not depend on the machine (I6).
#define CUESTA_VECTOR_CLONES __attribute__((target_clones("avx2", "default"), optimize("O3")))
#else
#define CUESTA_VECTOR_CLONES
#endif

/// The triangle's constants, computed once for all points. Directions come from f64: the normal of a needle
/// would be lost to cancellation in f32.
struct Planes {
  Vec3f a, b, c;
  Vec3f ab, bc, ca;
  Vec3f n;                    // unit, zero for a degenerate triangle
  Vec3f in_ab, in_bc, in_ca;  // unit, in the plane, positive outside
  float inv_ab, inv_bc, inv_ca;
  bool degenerate;
};

float inverse(float squared) {
  return squared > 0 ? 1.0f / squared : 0.0f;
}

Planes planes_of(Vec3f a, Vec3f b, Vec3f c) {
  const Vec3d ab = vec_cast<double>(b) - vec_cast<double>(a);
  const Vec3d bc = vec_cast<double>(c) - vec_cast<double>(b);
  const Vec3d ca = vec_cast<double>(a) - vec_cast<double>(c);
  const Vec3d n = normalized(cross(ab, -ca));
  const auto outwards = [&n](Vec3d e) { return vec_cast<float>(normalized(cross(e, n))); };
  Planes p{a, b, c, b - a, c - b, a - c, vec_cast<float>(n), outwards(ab), outwards(bc), outwards(ca),
           0, 0, 0, false};
  p.inv_ab = inverse(dot(p.ab, p.ab));
  p.inv_bc = inverse(dot(p.bc, p.bc));
  p.inv_ca = inverse(dot(p.ca, p.ca));
  p.degenerate = !(dot(n, n) > 0);
  return p;
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

CUESTA_VECTOR_CLONES
void measure_all(std::size_t n, const float* __restrict x, const float* __restrict y,
                 const float* __restrict z, float* __restrict best, std::int32_t* __restrict nearest,
                 const Planes p, std::int32_t index) {
  for (std::size_t i = 0; i < n; ++i) {
    const float ax = x[i] - p.a.x, ay = y[i] - p.a.y, az = z[i] - p.a.z;
    const float bx = x[i] - p.b.x, by = y[i] - p.b.y, bz = z[i] - p.b.z;
    const float cx = x[i] - p.c.x, cy = y[i] - p.c.y, cz = z[i] - p.c.z;
    const float oab = ax * p.in_ab.x + ay * p.in_ab.y + az * p.in_ab.z;
    const float obc = bx * p.in_bc.x + by * p.in_bc.y + bz * p.in_bc.z;
    const float oca = cx * p.in_ca.x + cy * p.in_ca.y + cz * p.in_ca.z;
    const float outside = std::max(std::max(oab, obc), oca);
    const float h = ax * p.n.x + ay * p.n.y + az * p.n.z;
    const float plane = h * h;
    const float dab = to_segment(ax, ay, az, p.ab, p.inv_ab);
    const float dbc = to_segment(bx, by, bz, p.bc, p.inv_bc);
    const float dca = to_segment(cx, cy, cz, p.ca, p.inv_ca);
    const float edge = std::min(std::min(dab, dbc), dca);
    const float d = (outside <= 0.0f && !p.degenerate) ? plane : edge;
    nearest[i] = d < best[i] ? index : nearest[i];
    best[i] = d < best[i] ? d : best[i];
  }
}

}  // namespace

void DeviationBatch::grow() {
  const std::size_t capacity = std::max<std::size_t>(64, x_.size() * 2);
  for (auto* v : {&x_, &y_, &z_, &best_}) v->resize(capacity);
  nearest_.resize(capacity);
}

void DeviationBatch::add(Vec3f p) {
  if (size_ == x_.size()) grow();
  x_[size_] = p.x;
  y_[size_] = p.y;
  z_[size_] = p.z;
  best_[size_] = std::numeric_limits<float>::max();
  nearest_[size_] = -1;
  ++size_;
}

void DeviationBatch::measure(Vec3f a, Vec3f b, Vec3f c, std::int32_t index) {
  longest_edge_squared_ =
      std::max({longest_edge_squared_, dot(b - a, b - a), dot(c - b, c - b), dot(a - c, a - c)});
  measure_all(size_, x_.data(), y_.data(), z_.data(), best_.data(), nearest_.data(), planes_of(a, b, c),
              index);
}

float DeviationBatch::worst_bound() const {
  float worst = 0;
  for (std::size_t i = 0; i < size_; ++i) worst = std::max(worst, best_[i]);
  const float rounding = std::sqrt(longest_edge_squared_) * rounding_per_length;
  if (worst == 0 && rounding < negligible) return 0;
  return std::sqrt(worst) * (1 + relative_rounding) + rounding;
}

}  // namespace cuesta
