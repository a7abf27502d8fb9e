#pragma once
/// A flight as it is played, in the viewer's time.

#include <optional>

#include "runtime/flight.h"

namespace cuesta::view {

class FlightPlayer {
 public:
  /// @pre flight has a keyframe
  void set(Flight flight) { flight_ = std::move(flight); }
  bool has_flight() const { return flight_.has_value(); }
  bool playing() const { return start_s_.has_value(); }
  /// From its beginning.   @pre has_flight()
  void start(double now_s) { start_s_ = now_s; }
  void stop() { start_s_.reset(); }
  /// Where the camera is now; its last place ends the flight.   @pre playing()
  View view(double now_s, const View& picture);

 private:
  std::optional<Flight> flight_;
  std::optional<double> start_s_;
};

}  // namespace cuesta::view
