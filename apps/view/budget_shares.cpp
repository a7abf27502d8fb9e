#include "apps/view/budget_shares.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

namespace cuesta::view {
namespace {

constexpr double least_weight = 0.02;

template <class T>
T part_of(T total, double fraction) {
  if (total == std::numeric_limits<T>::max()) return total;
  if (fraction >= 1) return total;  // doubles may not hold the total
  return static_cast<T>(static_cast<double>(total) * fraction);
}

std::vector<double> fractions_of(std::span<const double> weights) {
  const double sum = std::accumulate(weights.begin(), weights.end(), 0.0);
  std::vector<double> fractions;
  for (const double w : weights) fractions.push_back(w / sum);
  return fractions;
}

}  // namespace

double visible_weight(const View& view, Vec3d centre, double radius) {
  const auto [right, up, back] = view.frame();
  const Vec3d to = centre - view.eye;
  const double distance = std::max(length(to), 1e-300);
  if (distance <= radius) return 1;  // inside
  const double tan_y = std::tan(view.fov_y_rad / 2), tan_x = tan_y * view.width_px / view.height_px;
  const double ahead = dot(to, -back);
  const double half_diagonal = std::atan(std::hypot(tan_x, tan_y)), size = std::asin(radius / distance);
  const double off_axis = std::acos(std::clamp(ahead / distance, -1.0, 1.0));
  if (off_axis > half_diagonal + size) return least_weight;  // outside the picture
  const double covered = std::pow(std::tan(size), 2) / (tan_x * tan_y);
  return std::clamp(covered, least_weight, 1.0);
}

std::vector<Budgets> share_budgets(const Budgets& total, std::span<const double> weights) {
  std::vector<Budgets> shares;
  for (const double fraction : fractions_of(weights)) {
    Budgets share = total;
    if (std::isfinite(total.adapt_ms)) share.adapt_ms = total.adapt_ms * fraction;
    share.triangles = part_of(total.triangles, fraction);
    share.upload_bytes = part_of(total.upload_bytes, fraction);
    share.page_loads = total.page_loads == 0 ? 0 : std::max(1u, part_of(total.page_loads, fraction));
    shares.push_back(share);
  }
  return shares;
}

std::vector<std::uint64_t> share_bytes(std::uint64_t total, std::span<const double> weights) {
  std::vector<std::uint64_t> shares;
  for (const double fraction : fractions_of(weights)) shares.push_back(part_of(total, fraction));
  return shares;
}

}  // namespace cuesta::view
