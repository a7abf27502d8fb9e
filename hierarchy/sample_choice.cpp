#include "hierarchy/sample_choice.h"

#include <algorithm>
#include <numeric>

#include "ooc/check.h"

namespace cuesta {
namespace {

constexpr std::uint32_t nobody = 0xFFFFFFFFu;

/// Largest n with n² parts in at most 7/8 of the samples: 5 for 32, so that 7 remain for the farthest
/// anywhere.
std::uint32_t cuts_for(std::size_t most) {
  std::uint32_t n = 1;
  while (8 * std::size_t{n + 1} * (n + 1) <= 7 * most) ++n;
  return n;
}

/// The triangle's edges are cut `n` times, which gives n² parts.
class Parts {
 public:
  Parts(const std::array<Vec3f, 3>& t, std::uint32_t n)
      : a_(t[0]), ab_(t[1] - t[0]), ac_(t[2] - t[0]), n_(n) {
    const Vec3f normal = cross(ab_, ac_);
    const float squared = dot(normal, normal);
    if (!(squared > 0)) return;  // all in one part
    to_b_ = cross(ac_, normal) / squared;
    to_c_ = cross(normal, ab_) / squared;
  }
  /// Numbers below 2 n², n² of which are in use. Points outside belong to a part at the border.
  std::size_t of(Vec3f p) const {
    const auto n = static_cast<float>(n_);
    float v = std::clamp(dot(p - a_, to_b_), 0.0f, 1.0f) * n,
          w = std::clamp(dot(p - a_, to_c_), 0.0f, 1.0f) * n;
    if (v + w > n) v = v * n / (v + w), w = n - v;
    const std::uint32_t i = std::min(static_cast<std::uint32_t>(v), n_ - 1);
    const std::uint32_t j = std::min(static_cast<std::uint32_t>(w), n_ - 1 - i);
    const bool far_half = i + j + 1 < n_ && v - static_cast<float>(i) + w - static_cast<float>(j) > 1;
    return 2 * (i * n_ + j) + far_half;
  }

 private:
  Vec3f a_, ab_, ac_, to_b_, to_c_;
  std::uint32_t n_;
};

}  // namespace

std::size_t SampleChoice::keep(std::span<Vec3f> samples, const std::array<Vec3f, 3>& triangle,
                               std::size_t most) {
  CUESTA_CHECK(most >= 2, most);
  if (samples.size() <= most) return samples.size();
  batch_.clear();
  for (const Vec3f& p : samples) batch_.add(p);
  batch_.measure({&triangle, 1});
  const auto farther = [this](std::uint32_t i, std::uint32_t k) {
    const float di = batch_.squared_distance(i), dk = batch_.squared_distance(k);
    return di != dk ? di > dk : i < k;
  };
  const std::uint32_t cuts = cuts_for(most);
  const Parts parts(triangle, cuts);
  farthest_.assign(std::size_t{2} * cuts * cuts, nobody);
  for (std::uint32_t i = 0; i < samples.size(); ++i) {
    std::uint32_t& f = farthest_[parts.of(samples[i])];
    if (f == nobody || farther(i, f)) f = i;
  }
  kept_.assign(samples.size(), 0);
  for (std::uint32_t f : farthest_)
    if (f != nobody) kept_[f] = 1;
  order_.resize(samples.size());
  std::iota(order_.begin(), order_.end(), 0u);
  std::nth_element(order_.begin(), order_.begin() + static_cast<std::ptrdiff_t>(most), order_.end(),
                   [&](std::uint32_t i, std::uint32_t k) {
                     return kept_[i] != kept_[k] ? kept_[i] > kept_[k] : farther(i, k);
                   });
  std::fill(kept_.begin(), kept_.end(), std::uint8_t{0});
  for (std::size_t k = 0; k < most; ++k) kept_[order_[k]] = 1;
  std::size_t count = 0;
  for (std::size_t i = 0; i < samples.size(); ++i)
    if (kept_[i]) samples[count++] = samples[i];
  return count;
}

}  // namespace cuesta
