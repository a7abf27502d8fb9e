#include "hierarchy/bounding_sphere.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <vector>

#include "hierarchy/vector_clones.h"
#include "ooc/check.h"

namespace cuesta {
namespace {

constexpr int centre_steps = 3;  // 8: radii 0.5 % smaller, half as much time again for a page

/// Balls in structure-of-arrays form, filled up with the first one to whole vectors.
constexpr std::size_t lanes = 8;
class Balls {
 public:
  explicit Balls(std::span<const Sphere> balls) : size_((balls.size() + lanes - 1) / lanes * lanes) {
    if (size_ > few) {
      many_.resize(4 * size_);
      many_distances_.resize(size_);
    }
    distance = size_ > few ? many_distances_.data() : some_distances_;
    float* at = size_ > few ? many_.data() : some_;
    for (float** axis : {&x, &y, &z, &r}) {
      *axis = at;
      at += size_;
    }
    for (std::size_t i = 0; i < size_; ++i) {
      const Sphere& s = balls[i < balls.size() ? i : 0];
      x[i] = s.centre.x;
      y[i] = s.centre.y;
      z[i] = s.centre.z;
      r[i] = s.radius;
    }
  }
  Balls(const Balls&) = delete;
  Balls& operator=(const Balls&) = delete;
  std::size_t size() const { return size_; }
  Sphere operator[](std::size_t i) const { return {{x[i], y[i], z[i]}, r[i]}; }

  float *x, *y, *z, *r;
  std::int32_t* distance;  // scratch: the bits of distances

 private:
  static constexpr std::size_t few = 128;
  std::size_t size_;
  float some_[4 * few];
  std::int32_t some_distances_[few];
  std::vector<float> many_;
  std::vector<std::int32_t> many_distances_;
};

/// Farthest point of the balls from `c`: index of the first such ball, and distance.
struct Farthest {
  std::size_t index = 0;
  float distance = 0;
};

// The loops become vector instructions. Distances are not negative, so their bits are in their order, and
// integers have a maximum that does not depend on the order of evaluation.
[[gnu::always_inline]] inline Farthest farthest(const Balls& balls, Vec3f c) {
  const float* __restrict x = balls.x;
  const float* __restrict y = balls.y;
  const float* __restrict z = balls.z;
  const float* __restrict r = balls.r;
  std::int32_t* __restrict distance = balls.distance;
  const std::size_t n = balls.size() / lanes * lanes;
  std::int32_t most = 0;
  for (std::size_t i = 0; i < n; ++i) {
    const float dx = x[i] - c.x, dy = y[i] - c.y, dz = z[i] - c.z;
    distance[i] = std::bit_cast<std::int32_t>(std::sqrt(dx * dx + dy * dy + dz * dz) + r[i]);
  }
  for (std::size_t i = 0; i < n; ++i) most = distance[i] > most ? distance[i] : most;
  std::size_t index = 0;
  while (distance[index] != most) ++index;
  return {index, std::bit_cast<float>(most)};
}

/// Midpoint of the two balls' far ends, starting from the ball farthest from the first one.
[[gnu::always_inline]] inline Vec3f first_guess(const Balls& balls) {
  const Sphere a = balls[farthest(balls, balls[0].centre).index];
  const Sphere b = balls[farthest(balls, a.centre).index];
  const float d = length(b.centre - a.centre);
  if (d + b.radius <= a.radius) return a.centre;
  if (d + a.radius <= b.radius) return b.centre;
  return a.centre + (b.centre - a.centre) * ((d + b.radius - a.radius) / (2 * d));
}

CUESTA_VECTOR_CLONES
Vec3f near_minimal_centre(const Balls& balls) {
  Vec3f c = first_guess(balls);
  Vec3f best = c;
  Farthest f = farthest(balls, c);
  float best_radius = f.distance;
  for (int step = 1; step <= centre_steps; ++step) {
    const Vec3f to = balls[f.index].centre - c;
    const float l = length(to);
    if (l <= 0) break;
    // Towards the far end of the farthest ball, not only its centre.
    c = c + to * ((1 + balls[f.index].radius / l) / static_cast<float>(2 + 2 * step));
    f = farthest(balls, c);
    if (f.distance < best_radius) {
      best = c;
      best_radius = f.distance;
    }
  }
  return best;
}

std::int8_t quantize_offset(double offset, double unit) {
  return static_cast<std::int8_t>(std::clamp(std::round(offset / unit), -127.0, 127.0));
}

SphereCode with_offset(std::uint16_t radius, Vec3d offset) {
  const std::uint32_t exponent = (static_cast<std::uint32_t>(radius) << 16) & 0x7F800000u;
  const double unit = static_cast<double>(std::bit_cast<float>(exponent)) / 64;
  if (!(unit > 0)) return {radius, 0, 0, 0};
  return {radius, quantize_offset(offset.x, unit), quantize_offset(offset.y, unit),
          quantize_offset(offset.z, unit)};
}

/// Radius that a ball at `centre` needs to contain all, in the sense of contains().
CUESTA_VECTOR_CLONES
double needed_radius(const Balls& balls, Vec3f centre) {
  const float* __restrict x = balls.x;
  const float* __restrict y = balls.y;
  const float* __restrict z = balls.z;
  const float* __restrict r = balls.r;
  const Vec3d c = vec_cast<double>(centre);
  const std::size_t n = balls.size() / lanes * lanes;
  std::int64_t needed = 0;
  for (std::size_t i = 0; i < n; ++i) {
    const double dx = c.x - static_cast<double>(x[i]);
    const double dy = c.y - static_cast<double>(y[i]);
    const double dz = c.z - static_cast<double>(z[i]);
    const auto here = std::bit_cast<std::int64_t>(std::sqrt(dx * dx + dy * dy + dz * dz) * (1 + 2e-12) +
                                                  static_cast<double>(r[i]));
    needed = here > needed ? here : needed;
  }
  return std::bit_cast<double>(needed);
}

std::uint16_t encode_up(double r) {
  const float f = static_cast<float>(r);
  return encode_radius_up(
      static_cast<double>(f) < r ? std::nextafter(f, std::numeric_limits<float>::infinity()) : f);
}

}  // namespace

SphereCode enclose(std::span<const Sphere> inner, Vec3i fan_centre) {
  CUESTA_CHECK(!inner.empty());
  const Balls balls(inner);
  const Vec3f centre = near_minimal_centre(balls);
  const Vec3d offset = vec_cast<double>(centre) - vec_cast<double>(fan_centre);
  std::uint16_t radius = encode_up(needed_radius(balls, centre));
  // The offset's unit follows the radius, and the radius the rounded offset: grows to a fixed point.
  for (;;) {
    const SphereCode code = with_offset(radius, offset);
    const std::uint16_t needed = encode_up(needed_radius(balls, decode_sphere(code, fan_centre).centre));
    if (needed <= radius) return code;
    radius = needed;
  }
}

}  // namespace cuesta
