#include "apps/measure/spatial_order.h"

#include <tbb/parallel_sort.h>

namespace cuesta::measure {
namespace {

struct Key {
  std::uint64_t code;
  std::uint32_t index;
  auto operator<=>(const Key&) const = default;
};

/// Two zero bits after each of 21 bits.
std::uint64_t spread(std::uint64_t v) {
  v = (v | v << 32) & 0x001f00000000ffffull;
  v = (v | v << 16) & 0x001f0000ff0000ffull;
  v = (v | v << 8) & 0x100f00f00f00f00full;
  v = (v | v << 4) & 0x10c30c30c30c30c3ull;
  return (v | v << 2) & 0x1249249249249249ull;
}

std::uint64_t morton(Vec3d unit) {
  constexpr double cells = (1 << 21) - 1;
  const Vec3d c = unit * cells;
  return spread(static_cast<std::uint64_t>(c.x)) | spread(static_cast<std::uint64_t>(c.y)) << 1 |
         spread(static_cast<std::uint64_t>(c.z)) << 2;
}

}  // namespace

std::vector<std::uint32_t> spatial_order(std::span<const Vec3d> points) {
  Box3d box;
  for (const Vec3d& p : points) {
    if (is_finite(p)) box.add(p);
  }
  if (box.empty()) return {};
  const Vec3d size = box.hi - box.lo;
  const double longest = std::max({size.x, size.y, size.z});
  const double scale = longest > 0 ? 1 / longest : 0;
  std::vector<Key> keys;
  keys.reserve(points.size());
  for (std::uint32_t i = 0; i < points.size(); ++i) {
    if (is_finite(points[i])) keys.push_back({morton((points[i] - box.lo) * scale), i});
  }
  tbb::parallel_sort(keys.begin(), keys.end());
  std::vector<std::uint32_t> order(keys.size());
  for (std::size_t i = 0; i < keys.size(); ++i) order[i] = keys[i].index;
  return order;
}

}  // namespace cuesta::measure
