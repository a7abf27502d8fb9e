#pragma once
/// Order statistics of a set of measured values.

#include <cstdint>
#include <vector>

namespace cuesta::measure {

/// Nearest-rank percentiles (each is one of the values), in the values' unit. All zero without values.
struct Percentiles {
  double p50 = 0, p90 = 0, p99 = 0, p999 = 0, max = 0;
  std::uint64_t count = 0;
};

/// @pre no value is NaN.   @cost O(n); takes its own copy.
Percentiles percentiles(std::vector<double> values);

}  // namespace cuesta::measure
