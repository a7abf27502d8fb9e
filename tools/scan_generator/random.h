#pragma once
/// The same random numbers on every machine. Source: Steele, Lea, Flood, "Fast Splittable Pseudorandom Number
/// Generators" (SplitMix64), OOPSLA 2014.

#include <cstdint>
#include <span>
#include <utility>

namespace cuesta::tools {

/// A good hash of 64 bits.
constexpr std::uint64_t mixed(std::uint64_t x) {
  x += 0x9e3779b97f4a7c15ull;
  x = (x ^ x >> 30) * 0xbf58476d1ce4e5b9ull;
  x = (x ^ x >> 27) * 0x94d049bb133111ebull;
  return x ^ x >> 31;
}

/// [0, 1) from the upper 53 bits.
constexpr double unit_interval(std::uint64_t bits) {
  return static_cast<double>(bits >> 11) * 0x1p-53;
}

/// Fisher–Yates shuffle. @pre fewer than 2^32 items.
template <class T>
void shuffle(std::span<T> items, std::uint64_t seed) {
  for (std::size_t i = items.size(); i > 1; --i) {
    const std::uint64_t j = (mixed(seed + i) >> 32) * i >> 32;
    std::swap(items[i - 1], items[j]);
  }
}

}  // namespace cuesta::tools
