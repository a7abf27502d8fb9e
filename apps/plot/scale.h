#pragma once
/// From values to pixels, and round numbers to mark on the way.

#include <string>
#include <vector>

namespace cuesta::plot {

struct Tick {
  double value;
  std::string label;  ///< empty: a minor tick
};

/// Maps [low, high] to [from_px, to_px], linearly or by logarithm.
struct Scale {
  double low = 0, high = 1;  ///< low < high; both > 0 if logarithmic
  bool logarithmic = false;
  double from_px = 0, to_px = 1;

  bool accepts(double value) const;       ///< finite, and positive if logarithmic
  double operator()(double value) const;  ///< @pre accepts(value)
};

/// About `wanted` ticks at 1, 2 or 5 times a power of ten (logarithmic: powers of ten, with 2 and 5 on short
/// axes).
std::vector<Tick> ticks(const Scale& scale, int wanted);

/// Widens [low, high] to round numbers: `wanted` as for ticks(). Logarithmic: to 1, 2 or 5 times a power of
/// ten.
void widen(Scale& scale, int wanted);

/// "0.25", "20 k", "1.5 M", "2×10⁻⁵": at most `decimals` decimals, no trailing zeros.
std::string short_number(double value, int decimals);

}  // namespace cuesta::plot
