#pragma once
/// cuesta flight: a flight file around a model, for render and for benchmarks.

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "ooc/result.h"
#include "runtime/flight.h"

namespace cuesta::app {

struct FlightSettings {
  std::filesystem::path file, output;
  FlightKind kind = FlightKind::orbit;
  std::uint64_t frames = 300;
  double fps = 30;
  View view;                       ///< picture size, angle, up
  bool up_given = false;           ///< else a terrain's up is its own
  double exaggeration = 1;         ///< of a terrain's heights
  std::vector<std::string> route;  ///< terrain, fly-over: pairs of latitude and longitude
  double above_ground_m = 0;       ///< terrain, fly-over; 0: by the route's length
};

/// @error of reading the .cuesta file; io.
Result<void> run_flight(const FlightSettings& settings);

}  // namespace cuesta::app
