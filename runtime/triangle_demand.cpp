#include "runtime/triangle_demand.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>

namespace cuesta {
namespace {

// Bins of sse with 128 to the octave, from 2^-40 to 2^44: the upper bits of a positive double.
constexpr int bin_shift = 45;
constexpr std::uint64_t lowest = std::uint64_t{1023 - 40} << (52 - bin_shift);
constexpr std::size_t bins = std::size_t{84} << (52 - bin_shift);

std::size_t bin_of(double sse) {
  const std::uint64_t bits = std::bit_cast<std::uint64_t>(sse) >> bin_shift;
  return static_cast<std::size_t>(std::clamp(bits, lowest, lowest + bins - 1) - lowest);
}
double bin_floor(std::size_t bin) {
  return std::bit_cast<double>((lowest + bin) << bin_shift);
}

}  // namespace

bool TriangleDemand::count(const PageCache& cache, const ErrorScale& scale,
                           const std::function<double(PageId)>& factor, double floor,
                           std::uint64_t triangle_budget, const std::function<bool()>& out_of_time) {
  if (!running_) {
    gain_.assign(bins, 0);
    coarsest_ = cache.pool().active_triangles();
    next_ = 0;
    running_ = true;
  }
  for (; next_ < cache.resident_ids().size(); ++next_) {
    if (out_of_time()) return false;
    const PageId id = cache.resident_ids()[next_];
    add_page(*cache.resident(id), scale, factor(id), floor);
  }
  finish(floor, triangle_budget);
  running_ = false;
  return true;
}

void TriangleDemand::add_page(const ResidentPage& page, const ErrorScale& scale, double factor,
                              double floor) {
  for (std::size_t f = 0; f < page.fans().size(); ++f) {
    const FanState& fan = page.fans()[f];
    const double s = scale.scale(page.sphere(f), factor);
    const auto children = page.children(fan);
    for (std::size_t i = 0; i < children.size(); ++i) {
      if (i >= fan.applied) coarsest_ -= children[i].removed;
      if (children[i].error == 0) {
        if (floor < 0) gain_.front() += children[i].removed;
        continue;
      }
      const double sse = static_cast<double>(decode_error(children[i].error)) / s;
      if (sse > floor) gain_[bin_of(sse)] += children[i].removed;
    }
  }
}

void TriangleDemand::finish(double floor, std::uint64_t triangle_budget) {
  std::uint64_t total = coarsest_;
  tau_ = next_tau_ = floor;
  if (total > triangle_budget) tau_ = next_tau_ = std::numeric_limits<double>::infinity();
  for (std::size_t bin = bins; bin-- > 0 && total <= triangle_budget;) {
    total += gain_[bin];
    if (total <= triangle_budget) continue;
    tau_ = bin + 1 == bins ? std::numeric_limits<double>::max() : std::nextafter(bin_floor(bin + 1), 0);
    next_tau_ = bin == 0 ? floor : std::nextafter(bin_floor(bin), 0);
  }
  tau_ = std::max(tau_, floor);
  next_tau_ = std::max(next_tau_, floor);
}

}  // namespace cuesta
