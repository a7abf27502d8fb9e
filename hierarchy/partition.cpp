#include "hierarchy/partition.h"

#include <algorithm>
#include <array>
#include <numeric>

#include "ooc/check.h"

namespace cuesta {
namespace {

class KdCutter {
 public:
  KdCutter(std::span<const Vec3f> centres, const Axes& axes, std::vector<std::uint32_t>& order,
           std::vector<std::uint32_t>& begin)
      : order_(order), begin_(begin) {
    turned_.reserve(centres.size());
    for (const Vec3f& c : centres) turned_.push_back(turn(axes, c));
  }

  void cut(std::uint32_t first, std::uint32_t last, std::uint32_t cells) {
    if (cells == 1) {
      std::sort(order_.begin() + first, order_.begin() + last);
      begin_.push_back(last);
      return;
    }
    const int axis = longest_axis(first, last);
    const std::uint32_t left = cells / 2;
    const std::uint32_t middle =
        first + static_cast<std::uint32_t>(std::uint64_t{last - first} * left / cells);
    const auto before = [&](std::uint32_t a, std::uint32_t b) {
      const float ka = turned_[a][axis], kb = turned_[b][axis];
      return ka != kb ? ka < kb : a < b;
    };
    std::nth_element(order_.begin() + first, order_.begin() + middle, order_.begin() + last, before);
    cut(first, middle, left);
    cut(middle, last, cells - left);
  }

 private:
  int longest_axis(std::uint32_t first, std::uint32_t last) const {
    Box3<float> box;
    for (std::uint32_t i = first; i < last; ++i) box.add(turned_[order_[i]]);
    const Vec3f e = box.hi - box.lo;
    return e.x >= e.y && e.x >= e.z ? 0 : e.y >= e.z ? 1 : 2;
  }

  std::vector<Vec3f> turned_;
  std::vector<std::uint32_t>& order_;
  std::vector<std::uint32_t>& begin_;
};

}  // namespace

/// Orthonormal axes that share no plane: rotations by unit quaternions far from each other's symmetries.
Axes axes_of(std::uint32_t round) {
  constexpr std::array<std::array<double, 4>, 4> turns{{{1, 0, 0, 0},
                                                        {0.8467, 0.2795, 0.3514, 0.2862},
                                                        {0.7071, -0.4253, 0.2611, 0.5003},
                                                        {0.6123, 0.5521, -0.4817, 0.2983}}};
  auto q = turns[round % turns.size()];
  const double norm = std::sqrt(q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3]);
  for (double& c : q) c /= norm;
  const auto [w, x, y, z] = q;
  const auto row = [](double a, double b, double c) {
    return Vec3f{static_cast<float>(a), static_cast<float>(b), static_cast<float>(c)};
  };
  return {row(1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)),
          row(2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)),
          row(2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y))};
}

Partition partition_cells(std::span<const Vec3f> centres, std::uint32_t cell_triangles, std::uint32_t round) {
  CUESTA_CHECK(cell_triangles > 0);
  CUESTA_CHECK(centres.size() < 0xFFFFFFFFu, centres.size());
  const std::uint32_t n = static_cast<std::uint32_t>(centres.size());
  Partition p;
  p.begin.push_back(0);
  if (n == 0) return p;
  p.order.resize(n);
  std::iota(p.order.begin(), p.order.end(), 0u);
  KdCutter(centres, axes_of(round), p.order, p.begin).cut(0, n, (n + cell_triangles - 1) / cell_triangles);
  return p;
}

}  // namespace cuesta
