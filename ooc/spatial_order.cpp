#include "ooc/spatial_order.h"

#include <array>
#include <cstddef>
#include <utility>

namespace cuesta {
namespace {

constexpr int kDigitBits = 11;
constexpr int kDigits = 6;  // 66 ≥ 64 bits
constexpr std::size_t kRadix = std::size_t{1} << kDigitBits;
using Histogram = std::array<std::size_t, kRadix>;

std::size_t digit(std::uint64_t key, int d) {
  return static_cast<std::size_t>(key >> (d * kDigitBits)) & (kRadix - 1);
}

/// Bits abc… become a00b00c00…
std::uint64_t spread(std::uint64_t v) {
  v &= 0x1fffff;
  v = (v | v << 32) & 0x001f00000000ffff;
  v = (v | v << 16) & 0x001f0000ff0000ff;
  v = (v | v << 8) & 0x100f00f00f00f00f;
  v = (v | v << 4) & 0x10c30c30c30c30c3;
  v = (v | v << 2) & 0x1249249249249249;
  return v;
}

void scatter(const std::vector<CurveEntry>& from, std::vector<CurveEntry>& to, Histogram& count, int d) {
  std::size_t sum = 0;
  for (std::size_t& c : count) sum += std::exchange(c, sum);
  for (const CurveEntry& e : from) to[count[digit(e.key, d)]++] = e;
}

}  // namespace

std::uint64_t morton_key(Vec3i g) {
  const auto bits = [](std::int32_t c) { return spread(static_cast<std::uint32_t>(c)); };
  return bits(g.x) | bits(g.y) << 1 | bits(g.z) << 2;
}

void sort_by_key(std::vector<CurveEntry>& entries) {
  std::vector<Histogram> counts(kDigits, Histogram{});
  for (const CurveEntry& e : entries)
    for (int d = 0; d < kDigits; ++d) ++counts[static_cast<std::size_t>(d)][digit(e.key, d)];
  std::vector<CurveEntry> other(entries.size());
  for (int d = 0; d < kDigits && !entries.empty(); ++d) {
    Histogram& count = counts[static_cast<std::size_t>(d)];
    if (count[digit(entries[0].key, d)] == entries.size()) continue;
    scatter(entries, other, count, d);
    entries.swap(other);
  }
}

}  // namespace cuesta
