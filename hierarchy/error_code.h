#pragma once
/// Errors and spheres as they are stored: few bits, rounded up, decoded with exact arithmetic only, so that
/// what was saturated when it was built (I3) is saturated on every machine that reads it.

#include <bit>
#include <cstdint>

#include "ooc/vec.h"

namespace cuesta {

/// An error in grid units as one byte: 0 is exactly zero; otherwise (8 + m)·2^(e - 9) with m of 3 and e of 5
/// bits: from 2^-6 to 2^26, in steps of at most 12.5 %.
using ErrorCode8 = std::uint8_t;

constexpr float decode_error(ErrorCode8 code) {
  if (code == 0) return 0;
  const std::uint32_t mantissa = 8u + (code & 7u);
  const std::uint32_t exponent = static_cast<std::uint32_t>(code) >> 3;
  // mantissa · 2^(exponent - 9); every factor is exact.
  return static_cast<float>(mantissa) * std::bit_cast<float>((exponent + 127u - 9u) << 23);
}

/// The smallest error that is not zero: twice what snapping to the grid moves a point (Grid::snap_error, half
/// the diagonal of a step), rounded up. A smaller one says less about the original than the grid hides, and
/// no cut of a larger τ is another for it. Zero stays zero: what is flat on the grid may go at once.
inline constexpr ErrorCode8 least_error_code = 54;
static_assert(decode_error(least_error_code) >= 1.7320509f &&
              decode_error(least_error_code - 1) < 1.7320508f);

/// Smallest code whose value is ≥ error, 0 for 0 and else at least least_error_code; saturates at 255 (2^26
/// grid units and more: beyond any extent in use).
constexpr ErrorCode8 encode_error_up(float error) {
  if (!(error > 0)) return 0;
  std::uint32_t low = least_error_code, high = 255;
  while (low < high) {
    const std::uint32_t middle = (low + high) / 2;
    if (decode_error(static_cast<ErrorCode8>(middle)) >= error)
      high = middle;
    else
      low = middle + 1;
  }
  return static_cast<ErrorCode8>(low);
}

/// Ball in grid units.
struct Sphere {
  Vec3f centre;
  float radius = 0;
};

/// A fan's sphere as stored: 5 bytes. The radius is the upper half of a float; the centre is the fan centre's
/// position plus offset · 2^(exponent of the radius) / 64.
struct SphereCode {
  std::uint16_t radius = 0;
  std::int8_t offset_x = 0, offset_y = 0, offset_z = 0;

  friend bool operator==(const SphereCode&, const SphereCode&) = default;
};

inline float decode_radius(std::uint16_t code) {
  return std::bit_cast<float>(static_cast<std::uint32_t>(code) << 16);
}
/// Smallest representable radius ≥ r, r ≥ 0 and finite.
inline std::uint16_t encode_radius_up(float r) {
  const std::uint32_t bits = std::bit_cast<std::uint32_t>(r);
  return static_cast<std::uint16_t>((bits >> 16) + ((bits & 0xFFFFu) != 0 ? 1u : 0u));
}

inline Sphere decode_sphere(SphereCode code, Vec3i fan_centre) {
  const std::uint32_t exponent = (static_cast<std::uint32_t>(code.radius) << 16) & 0x7F800000u;
  const double unit = static_cast<double>(std::bit_cast<float>(exponent)) / 64;
  return {{static_cast<float>(fan_centre.x + code.offset_x * unit),
           static_cast<float>(fan_centre.y + code.offset_y * unit),
           static_cast<float>(fan_centre.z + code.offset_z * unit)},
          decode_radius(code.radius)};
}

/// True if `outer` contains `inner`, with a margin for the rounding of view tests in f64: an eye up to 1000
/// times as far away as the centres are from each other sees the outer ball, as evaluated, no farther than
/// the inner one. (Beyond, the order could turn only where the balls touch, on the line to the eye, to within
/// 1e-15 of its distance; stored radii are rounded up by 0.4 % on average.)
inline bool contains(const Sphere& outer, const Sphere& inner) {
  const Vec3d d = vec_cast<double>(outer.centre) - vec_cast<double>(inner.centre);
  return static_cast<double>(outer.radius) - static_cast<double>(inner.radius) >= length(d) * (1 + 1e-12);
}

}  // namespace cuesta
