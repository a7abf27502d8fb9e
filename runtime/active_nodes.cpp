#include "runtime/active_nodes.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <numeric>
#include <utility>

#include "hierarchy/vector_clones.h"

namespace cuesta {
namespace {

constexpr std::uint32_t block = ActiveNodes::block;
constexpr double infinity = std::numeric_limits<double>::infinity();

constexpr double steps = 65535;  // of the 16-bit grid

/// Bound of the f32 evaluation of a limit, relative to its terms: nine roundings of 2^-24, the eye's and
/// limit_slack.
constexpr double rounding = 1.0 / (1 << 20);

struct Block {
  const std::uint16_t *x, *y, *z, *radius;
  const ErrorCode8 *undo_below, *apply_from;
};
struct Test {
  Vec3f eye;  // from the origin, in place units
  float place_unit, radius_unit, limit_per_unit, floor, hidden;
};

/// decode_error() without branches: codes from 1 on are the upper bits of a float.
float error_of(ErrorCode8 code) {
  const float e = std::bit_cast<float>((std::uint32_t{code} << 20) + (121u << 23));
  return code == 0 ? 0.0f : e;
}
static_assert(decode_error(1) == std::bit_cast<float>((1u << 20) + (121u << 23)) &&
              decode_error(254) == std::bit_cast<float>((254u << 20) + (121u << 23)));

/// How far the limit of each node may move before its decision changes, errors; conservative.
CUESTA_VECTOR_CLONES void margins(const Block& b, const Test& t, float* out) {
  for (std::uint32_t i = 0; i < block; ++i) {
    const float dx = static_cast<float>(b.x[i]) - t.eye.x, dy = static_cast<float>(b.y[i]) - t.eye.y,
                dz = static_cast<float>(b.z[i]) - t.eye.z;
    const float distance = std::sqrt(dx * dx + dy * dy + dz * dz) * t.place_unit;
    const float radius = static_cast<float>(b.radius[i]) * t.radius_unit;
    const float limit = std::max(distance - radius, t.floor) * t.limit_per_unit;
    const float slack = std::min(limit - error_of(b.undo_below[i]), error_of(b.apply_from[i]) - limit);
    out[i] = slack - t.limit_per_unit * (t.hidden + static_cast<float>(rounding) * (distance + radius));
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

void ActiveNodes::assign(std::span<const Sphere> spheres, std::span<const ErrorCode8> errors) {
  const auto fans = static_cast<std::uint32_t>(spheres.size());
  Box3d box;
  float largest = 0;
  for (const Sphere& s : spheres) {
    box.add(vec_cast<double>(s.centre));
    largest = std::max(largest, s.radius);
  }
  origin_ = fans > 0 ? box.lo : Vec3d{};
  const Vec3d size = fans > 0 ? box.hi - box.lo : Vec3d{};
  place_unit_ = static_cast<float>(std::max({size.x, size.y, size.z, 1.0}) / steps);
  radius_unit_ = static_cast<float>(std::max(static_cast<double>(largest), 1.0) / steps);
  const auto step = [](double v, float unit) {
    return static_cast<std::uint16_t>(std::clamp(std::round(v / static_cast<double>(unit)), 0.0, steps));
  };
  // By octave of error, then along a Morton curve: then most blocks are far from switching as a whole.
  std::vector<std::pair<std::uint64_t, std::uint32_t>> order(fans);
  for (std::uint32_t f = 0; f < fans; ++f) {
    const Vec3d c = vec_cast<double>(spheres[f].centre) - origin_;
    const auto cell = [&](double v) { return spread(step(v, place_unit_) >> 6u); };
    const std::uint64_t place = cell(c.x) | cell(c.y) << 1 | cell(c.z) << 2;
    order[f] = {static_cast<std::uint64_t>(errors[f] / 8) << 32 | place, f};
  }
  std::sort(order.begin(), order.end());
  const std::size_t nodes = (std::size_t{fans} + block - 1) / block * block;
  for (auto* column : {&x_, &y_, &z_, &radius_}) column->assign(nodes, 0);
  undo_below_.assign(nodes, 0);
  apply_from_.assign(nodes, FanBand::no_error);
  fan_of_node_.assign(nodes, 0);
  node_of_fan_.resize(fans);
  expiry_.assign(nodes / block, -infinity);
  for (std::uint32_t n = 0; n < fans; ++n) {
    const std::uint32_t f = order[n].second;
    const Vec3d c = vec_cast<double>(spheres[f].centre) - origin_;
    x_[n] = step(c.x, place_unit_);
    y_[n] = step(c.y, place_unit_);
    z_[n] = step(c.z, place_unit_);
    radius_[n] = step(spheres[f].radius, radius_unit_);
    fan_of_node_[n] = f;
    node_of_fan_[f] = n;
  }
}

std::uint32_t ActiveNodes::test(Vec3d eye, double limit_per_unit, double floor, double travelled, bool all,
                                std::vector<std::uint32_t>& fans) {
  if (!all && expiry_least_ > travelled) return 0;
  // Half a step in each of three directions and of the radius; a little more for the division by the unit.
  const Test t{vec_cast<float>((eye - origin_) / static_cast<double>(place_unit_)),
               place_unit_,
               radius_unit_,
               static_cast<float>(limit_per_unit),
               static_cast<float>(floor),
               0.88f * place_unit_ + 0.51f * radius_unit_};
  std::uint32_t looked_at = 0;
  expiry_least_ = infinity;
  for (std::uint32_t b = 0; b < expiry_.size(); ++b) {
    if (all || !(expiry_[b] > travelled)) {
      ++looked_at;
      const std::uint32_t n = b * block;
      float margin[block];
      margins({&x_[n], &y_[n], &z_[n], &radius_[n], &undo_below_[n], &apply_from_[n]}, t, margin);
      float least = margin[0];
      for (std::uint32_t i = 1; i < block; ++i) least = std::min(least, margin[i]);
      if (!(least > 0)) {
        for (std::uint32_t i = 0; i < block && n + i < node_of_fan_.size(); ++i)
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
  const double low = limit * (1 - rounding), high = limit * (1 + rounding);
  const std::size_t before = fans.size();
  for (std::uint32_t n = 0; n < node_of_fan_.size(); ++n)
    if (low < static_cast<double>(decode_error(undo_below_[n])) ||
        (apply_from_[n] != FanBand::no_error && high >= static_cast<double>(decode_error(apply_from_[n]))))
      fans.push_back(fan_of_node_[n]);
  expiry_least_ = fans.size() > before ? -infinity : infinity;
  std::fill(expiry_.begin(), expiry_.end(), expiry_least_);
  return static_cast<std::uint32_t>(expiry_.size());
}

std::uint32_t ActiveNodes::take_all(std::vector<std::uint32_t>& fans) {
  fans.resize(node_of_fan_.size());
  std::iota(fans.begin(), fans.end(), 0u);
  expiry_least_ = infinity;
  std::fill(expiry_.begin(), expiry_.end(), infinity);
  return static_cast<std::uint32_t>(expiry_.size());
}

std::uint64_t ActiveNodes::bytes() const {
  return fan_of_node_.size() * (4 * sizeof(std::uint16_t) + 2 + 4) + node_of_fan_.size() * 4 +
         expiry_.size() * 8;
}

}  // namespace cuesta
