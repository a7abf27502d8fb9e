#pragma once
/// Moves τ between frames so that budgets are seldom reached. The budgets themselves are held by adapt();
/// this keeps what is drawn even when they would cut it off. Source: DESIGN §6 "Regulator"; a dead band
/// between the two loads keeps a steady flight steady.

#include <algorithm>
#include <cmath>
#include <limits>

namespace cuesta {

class Regulator {
 public:
  /// @param load  the largest share of a budget that the last frame used
  /// @return the threshold of the next frame: a power of 1.02, or `floor` where that is larger.
  double next(double load, double floor) {
    load_ += (std::min(load, 2.0) - load_) * smoothing;
    factor_ *= load_ > upper_load ? up : load_ < lower_load ? down : 1.0;
    return at_least(floor);
  }
  /// From here on, tau and no less.
  void set(double tau) { factor_ = tau; }
  double at_least(double floor) {
    factor_ = std::max(factor_, floor);
    return factor_ > floor ? std::max(floor, step_up(factor_)) : floor;
  }
  /// The next power of 1.02: blocks are not tested again for less.
  static double step_up(double tau) {
    return tau > 0 && tau < std::numeric_limits<double>::max()
               ? std::exp2(std::ceil(std::log2(tau) / step) * step)
               : tau;
  }

 private:
  static constexpr double smoothing = 0.25, upper_load = 0.85, lower_load = 0.70, up = 1.02, down = 0.995;
  static constexpr double step = 0.0285691521967709;  // log2 1.02
  double load_ = 0;
  double factor_ = 0;
};

}  // namespace cuesta
