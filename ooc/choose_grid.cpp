#include "ooc/choose_grid.h"

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>

namespace cuesta {
namespace {

/// Lengths of edges, 0 when every edge of the sample has length 0.
struct EdgeLengths {
  double median = 0;
  double short_one = 0;  ///< 99 % are longer
};

EdgeLengths quantiles(std::vector<double> lengths) {
  std::erase_if(lengths, [](double l) { return !(l > 0); });
  if (lengths.empty()) return {};
  const auto quantile = [&lengths](std::size_t per_cent) {
    const auto at = lengths.begin() + static_cast<std::ptrdiff_t>(lengths.size() * per_cent / 100);
    std::nth_element(lengths.begin(), at, lengths.end());
    return *at;
  };
  return {quantile(50), quantile(1)};
}

double default_step(double extent, EdgeLengths edges) {
  const double fine = std::min(edges.median / kStepsPerMedianEdge, edges.short_one / kStepsPerShortEdge);
  const double step = std::max(fine, extent / kMaxDefaultSteps);
  return step > 0 ? std::max(step, std::numeric_limits<double>::min()) : 1;
}

/// Far from zero, neighbouring doubles can be further apart than a step: then the minimum itself is the
/// origin.
double round_down(double lo, double step) {
  double origin = std::floor(lo / step) * step;
  if (origin > lo) origin -= step;
  return origin <= lo && lo - origin <= 2 * step ? origin : lo;
}

double largest(Vec3d v) {
  return std::max({v.x, v.y, v.z});
}

}  // namespace

Result<Grid> choose_grid(const Box3d& box, std::vector<double> edge_lengths, double step) {
  if (!(step >= 0) || std::isinf(step))
    return fail(ErrorCode::invalid_input, "", "",
                "the grid step must be a positive number, or 0 for a default");
  if (box.empty()) return Grid{};
  const double extent = largest(box.hi - box.lo);
  if (step == 0) step = default_step(extent, quantiles(std::move(edge_lengths)));
  const Grid grid{{round_down(box.lo.x, step), round_down(box.lo.y, step), round_down(box.lo.z, step)}, step};
  if (!(largest((box.hi - grid.origin) / step) + 1 < kMaxGridCoordinate))
    return fail(ErrorCode::invalid_input, "", "",
                "an extent of " + std::to_string(extent) + " is more than 2^30 grid steps of " +
                    std::to_string(step) + "; use a larger step");
  return grid;
}

}  // namespace cuesta
