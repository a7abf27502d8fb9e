#pragma once
/// A flight as it is flown: a keyframe now and then, none while the camera is still.

#include <optional>

#include "runtime/flight.h"

namespace cuesta::view {

class FlightRecorder {
 public:
  static constexpr double least_interval_s = 0.1;  ///< between keyframes

  bool recording() const { return recording_; }
  double seconds() const { return recording_ ? now_s_ - start_s_ : 0; }

  void start(double now_s);
  /// The camera as it is now; `now_s` never goes back. Nothing while not recording.
  void add(double now_s, const View& view);
  /// Ends. @return the flight, from time 0; nothing if no camera was added.
  std::optional<Flight> finish();

 private:
  void push(double now_s, const View& view);

  bool recording_ = false;
  double start_s_ = 0, now_s_ = 0;
  Flight flight_;
  std::optional<View> last_;  ///< what came last, at now_s_
};

}  // namespace cuesta::view
