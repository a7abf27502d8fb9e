#pragma once
/// cuesta flight: a flight file around a model, for render and for benchmarks.

#include <cstdint>
#include <filesystem>

#include "ooc/result.h"
#include "runtime/flight.h"

namespace cuesta::app {

struct FlightSettings {
  std::filesystem::path file, output;
  FlightKind kind = FlightKind::orbit;
  std::uint64_t frames = 300;
  double fps = 30;
  View view;  ///< picture size, angle, up
};

/// @error of reading the .cuesta file; io.
Result<void> run_flight(const FlightSettings& settings);

}  // namespace cuesta::app
