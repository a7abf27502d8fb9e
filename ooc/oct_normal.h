#pragma once
/// Octahedral normals. Source: Cigolle et al., "A Survey of Efficient Representations for Independent Unit
/// Vectors", JCGT 2014, §3.

#include <array>
#include <cmath>
#include <cstdint>

#include "ooc/vec.h"

namespace cuesta {

/// Unit vector → octahedral (u, v) as signed integers of `bits` bits (2…16): ±(2^(bits-1) - 1) is ±1.
/// The zero vector (no normal) gives the one code that no unit vector has: both -2^(bits-1).
inline std::array<std::int16_t, 2> encode_oct(Vec3f n, int bits) {
  const float scale = static_cast<float>((1 << (bits - 1)) - 1);
  const float sum = std::abs(n.x) + std::abs(n.y) + std::abs(n.z);
  if (!(sum > 0))
    return {static_cast<std::int16_t>(-(1 << (bits - 1))), static_cast<std::int16_t>(-(1 << (bits - 1)))};
  float u = n.x / sum;
  float v = n.y / sum;
  if (n.z < 0) {
    const float folded = (1 - std::abs(v)) * (u >= 0 ? 1.0f : -1.0f);
    v = (1 - std::abs(u)) * (v >= 0 ? 1.0f : -1.0f);
    u = folded;
  }
  return {static_cast<std::int16_t>(std::lround(u * scale)),
          static_cast<std::int16_t>(std::lround(v * scale))};
}

/// Inverse of encode_oct; unit, or zero for the "no normal" code. Angle error at 10 bits: at most 0.25°.
inline Vec3f decode_oct(std::array<std::int16_t, 2> code, int bits) {
  const std::int16_t none = static_cast<std::int16_t>(-(1 << (bits - 1)));
  if (code[0] == none && code[1] == none) return {};
  const float scale = static_cast<float>((1 << (bits - 1)) - 1);
  Vec3f n{static_cast<float>(code[0]) / scale, static_cast<float>(code[1]) / scale, 0};
  n.z = 1 - std::abs(n.x) - std::abs(n.y);
  if (n.z < 0) {
    const float folded = (1 - std::abs(n.y)) * (n.x >= 0 ? 1.0f : -1.0f);
    n.y = (1 - std::abs(n.x)) * (n.y >= 0 ? 1.0f : -1.0f);
    n.x = folded;
  }
  return normalized(n);
}

}  // namespace cuesta
