#pragma once
/// x^e for many x of one exponent, in loops that compilers turn into vector instructions: no branches, tables
/// or calls.

#include <algorithm>
#include <bit>
#include <cstdint>

namespace cuesta {

/// Largest relative error of vector_power, measured over its whole range in power_test.
inline constexpr double vector_power_error = 2e-8;
/// Bases are taken into this range: 0 and infinity give the smallest and the largest power.
inline constexpr double vector_power_least = 0x1p-120, vector_power_most = 0x1p120;

/// Binary logarithm of a normal x > 0, to 2e-9 absolute: the series of atanh about the nearest power of two.
inline double vector_log2(double x) {
  constexpr std::uint64_t root_half = 0x3fe6a09e667f3bcd, one = std::uint64_t{1023} << 52;
  const std::uint64_t bits = std::bit_cast<std::uint64_t>(x);
  const std::uint64_t biased = (bits - root_half + one) >> 52;
  const double exponent =
      std::bit_cast<double>(biased | std::bit_cast<std::uint64_t>(0x1p52)) - (0x1p52 + 1023);
  const double m = std::bit_cast<double>(bits - (biased << 52) + one);
  const double z = (m - 1) / (m + 1), q = z * z;
  constexpr double c = 2.885390081777926815;  // 2 / ln 2
  return exponent + z * (c + q * (c / 3 + q * (c / 5 + q * (c / 7 + q * (c / 9)))));
}

/// 2^y for |y| ≤ 1000, to 1e-8 relative: Taylor's series about the nearest integer.
inline double vector_exp2(double y) {
  constexpr double to_integer = 0x1.8p52, ln2 = 0.693147180559945309;
  const double shifted = y + to_integer;
  const double f = (y - (shifted - to_integer)) * ln2;
  const double p =
      1 + f * (1 + f * (1. / 2 + f * (1. / 6 + f * (1. / 24 + f * (1. / 120 + f * (1. / 720 + f / 5040))))));
  return std::bit_cast<double>(std::bit_cast<std::uint64_t>(p) +
                               (std::bit_cast<std::uint64_t>(shifted) << 52));
}

/// @param x  ≥ 0, may be infinite   @param exponent  within ±3
inline double vector_power(double x, double exponent) {
  return vector_exp2(exponent * vector_log2(std::min(std::max(x, vector_power_least), vector_power_most)));
}

}  // namespace cuesta
