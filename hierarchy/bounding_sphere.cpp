#include "hierarchy/bounding_sphere.h"

#include <algorithm>
#include <cmath>

#include "ooc/check.h"

namespace cuesta {
namespace {

constexpr int centre_steps = 8;

/// Farthest point of the balls from `c`: index and distance.
struct Farthest {
  std::size_t index = 0;
  float distance = 0;
};

Farthest farthest(std::span<const Sphere> balls, Vec3f c) {
  Farthest best{0, -1};
  for (std::size_t i = 0; i < balls.size(); ++i) {
    const float d = length(balls[i].centre - c) + balls[i].radius;
    if (d > best.distance) best = {i, d};
  }
  return best;
}

/// Midpoint of the two balls' far ends, starting from the ball farthest from the first one.
Vec3f first_guess(std::span<const Sphere> balls) {
  const Sphere& a = balls[farthest(balls, balls[0].centre).index];
  const Sphere& b = balls[farthest(balls, a.centre).index];
  const float d = length(b.centre - a.centre);
  if (d + b.radius <= a.radius) return a.centre;
  if (d + a.radius <= b.radius) return b.centre;
  return a.centre + (b.centre - a.centre) * ((d + b.radius - a.radius) / (2 * d));
}

Vec3f near_minimal_centre(std::span<const Sphere> balls) {
  Vec3f c = first_guess(balls);
  Vec3f best = c;
  float best_radius = farthest(balls, c).distance;
  for (int step = 1; step <= centre_steps; ++step) {
    const Farthest f = farthest(balls, c);
    if (f.distance < best_radius) {
      best = c;
      best_radius = f.distance;
    }
    const Vec3f to = balls[f.index].centre - c;
    const float l = length(to);
    if (l <= 0) break;
    // Towards the far end of the farthest ball, not only its centre.
    c = c + to * ((1 + balls[f.index].radius / l) / static_cast<float>(2 + 2 * step));
  }
  return farthest(balls, c).distance < best_radius ? c : best;
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
double needed_radius(std::span<const Sphere> inner, Vec3f centre) {
  double needed = 0;
  for (const Sphere& s : inner) {
    const Vec3d d = vec_cast<double>(centre) - vec_cast<double>(s.centre);
    needed = std::max(needed, length(d) * (1 + 2e-12) + static_cast<double>(s.radius));
  }
  return needed;
}

std::uint16_t encode_up(double r) {
  const float f = static_cast<float>(r);
  return encode_radius_up(
      static_cast<double>(f) < r ? std::nextafter(f, std::numeric_limits<float>::infinity()) : f);
}

}  // namespace

SphereCode enclose(std::span<const Sphere> inner, Vec3i fan_centre) {
  CUESTA_CHECK(!inner.empty());
  const Vec3f centre = near_minimal_centre(inner);
  const Vec3d offset = vec_cast<double>(centre) - vec_cast<double>(fan_centre);
  std::uint16_t radius = encode_up(needed_radius(inner, centre));
  // The offset's unit follows the radius, and the radius the rounded offset: grows to a fixed point.
  for (;;) {
    const SphereCode code = with_offset(radius, offset);
    const std::uint16_t needed = encode_up(needed_radius(inner, decode_sphere(code, fan_centre).centre));
    if (needed <= radius) return code;
    radius = needed;
  }
}

}  // namespace cuesta
