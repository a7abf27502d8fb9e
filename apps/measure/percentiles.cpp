#include "apps/measure/percentiles.h"

#include <algorithm>
#include <cmath>

namespace cuesta::measure {

Percentiles percentiles(std::vector<double> values) {
  if (values.empty()) return {};
  auto from = values.begin();
  const auto at = [&](double share) {  // ascending shares: each call may start where the last ended
    const double rank = std::ceil(share * static_cast<double>(values.size()));
    const auto place = values.begin() + static_cast<std::ptrdiff_t>(std::max(rank, 1.0)) - 1;
    std::nth_element(from, place, values.end());
    from = place;
    return *place;
  };
  Percentiles p;
  p.p50 = at(0.5);
  p.p90 = at(0.9);
  p.p99 = at(0.99);
  p.p999 = at(0.999);
  p.max = at(1.0);
  p.count = values.size();
  return p;
}

}  // namespace cuesta::measure
