#include "runtime/active_nodes.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

#include "hierarchy/vector_clones.h"

namespace cuesta {
namespace {

constexpr std::uint32_t block = ActiveNodes::block;
constexpr double infinity = std::numeric_limits<double>::infinity();

/// Bound of the f32 evaluation of a limit, relative to its terms: nine roundings of 2^-24, the eye's and limit_slack.
constexpr double rounding = 1.0 / (1 << 20);

struct Block {
  const float *x, *y, *z, *radius, *undo_below, *apply_from;
};

/// How far the limit of each node may move before its decision changes, errors; conservative by the rounding.
CUESTA_VECTOR_CLONES void margins(const Block& b, Vec3f eye, float limit_per_unit, float floor, float* out) {
  for (std::uint32_t i = 0; i < block; ++i) {
    const float dx = b.x[i] - eye.x, dy = b.y[i] - eye.y, dz = b.z[i] - eye.z;
    const float distance = std::sqrt(dx * dx + dy * dy + dz * dz);
    const float near = std::max(distance - b.radius[i], floor);
    const float limit = near * limit_per_unit;
    const float slack = std::min(limit - b.undo_below[i], b.apply_from[i] - limit);
    out[i] = slack - static_cast<float>(rounding) * limit_per_unit * (distance + b.radius[i]);
  }
}

std::uint64_t spread(std::uint32_t v) {  // ten bits to every third
  std::uint64_t x = v & 0x3FFu;
  x = (x | x << 16) & 0x30000FFu;
  x = (x | x << 8) & 0x300F00Fu;
  x = (x | x << 4) & 0x30C30C3u;
  return (x | x << 2) & 0x9249249u;
}

}  // namespace

void ActiveNodes::assign(Vec3i origin, std::span<const Sphere> spheres, std::span<const ErrorCode8> errors) {
  origin_ = vec_cast<double>(origin);
  const auto fans = static_cast<std::uint32_t>(spheres.size());
  Vec3f lo{}, hi{};
  for (std::uint32_t f = 0; f < fans; ++f) {
    const Vec3f c = spheres[f].centre;
    lo = f == 0 ? c : Vec3f{std::min(lo.x, c.x), std::min(lo.y, c.y), std::min(lo.z, c.z)};
    hi = f == 0 ? c : Vec3f{std::max(hi.x, c.x), std::max(hi.y, c.y), std::max(hi.z, c.z)};
  }
  const float extent = std::max({hi.x - lo.x, hi.y - lo.y, hi.z - lo.z, 1.0f});
  const auto cell = [&](float v, float least) { return static_cast<std::uint32_t>((v - least) / extent * 1023.0f); };
  // By octave of error, then along a Morton curve: then most blocks are far from switching as a whole.
  std::vector<std::pair<std::uint64_t, std::uint32_t>> order(fans);
  for (std::uint32_t f = 0; f < fans; ++f) {
    const Vec3f c = spheres[f].centre;
    const std::uint64_t place = spread(cell(c.x, lo.x)) | spread(cell(c.y, lo.y)) << 1 | spread(cell(c.z, lo.z)) << 2;
    order[f] = {static_cast<std::uint64_t>(errors[f] / 8) << 32 | place, f};
  }
  std::sort(order.begin(), order.end());
  const std::size_t nodes = (std::size_t{fans} + block - 1) / block * block;
  for (auto* column : {&x_, &y_, &z_, &radius_}) column->assign(nodes, 0);
  undo_below_.assign(nodes, -std::numeric_limits<float>::infinity());
  apply_from_.assign(nodes, std::numeric_limits<float>::infinity());
  fan_of_node_.assign(nodes, 0);
  node_of_fan_.resize(fans);
  expiry_.assign(nodes / block, -infinity);
  for (std::uint32_t n = 0; n < fans; ++n) {
    const std::uint32_t f = order[n].second;
    const Vec3d c = vec_cast<double>(spheres[f].centre) - origin_;
    x_[n] = static_cast<float>(c.x);
    y_[n] = static_cast<float>(c.y);
    z_[n] = static_cast<float>(c.z);
    radius_[n] = spheres[f].radius;
    fan_of_node_[n] = f;
    node_of_fan_[f] = n;
  }
}

std::uint32_t ActiveNodes::test(Vec3d eye, double limit_per_unit, double floor, double travelled, bool all,
                                std::vector<std::uint32_t>& fans) {
  if (!all && expiry_least_ > travelled) return 0;
  const Vec3f at = vec_cast<float>(eye - origin_);
  const auto per_unit = static_cast<float>(limit_per_unit);
  std::uint32_t looked_at = 0;
  expiry_least_ = infinity;
  for (std::uint32_t b = 0; b < expiry_.size(); ++b) {
    if (all || !(expiry_[b] > travelled)) {
      ++looked_at;
      const std::uint32_t n = b * block;
      float margin[block];
      margins({&x_[n], &y_[n], &z_[n], &radius_[n], &undo_below_[n], &apply_from_[n]}, at, per_unit,
              static_cast<float>(floor), margin);
      float least = margin[0];
      for (std::uint32_t i = 1; i < block; ++i) least = std::min(least, margin[i]);
      if (!(least > 0)) {
        for (std::uint32_t i = 0; i < block; ++i)
          if (!(margin[i] > 0)) fans.push_back(fan_of_node_[n + i]);
        least = 0;
      }
      expiry_[b] = travelled + static_cast<double>(least) / limit_per_unit;
    }
    expiry_least_ = std::min(expiry_least_, expiry_[b]);
  }
  return looked_at;
}

std::uint32_t ActiveNodes::test_uniform(double limit, std::vector<std::uint32_t>& fans) {
  const auto low = static_cast<float>(limit * (1 - rounding)), high = static_cast<float>(limit * (1 + rounding));
  const std::size_t before = fans.size();
  for (std::uint32_t n = 0; n < fan_of_node_.size(); ++n)
    if (low < undo_below_[n] || (high >= apply_from_[n] && apply_from_[n] < std::numeric_limits<float>::infinity()))
      fans.push_back(fan_of_node_[n]);
  expiry_least_ = fans.size() > before ? -infinity : infinity;
  std::fill(expiry_.begin(), expiry_.end(), expiry_least_);
  return static_cast<std::uint32_t>(expiry_.size());
}

std::uint64_t ActiveNodes::bytes() const {
  return fan_of_node_.size() * (6 * sizeof(float) + 4) + node_of_fan_.size() * 4 + expiry_.size() * 8;
}

}  // namespace cuesta
