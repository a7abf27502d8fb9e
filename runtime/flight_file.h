#pragma once
/// Flights as JSON: {"fps": 30, "keyframes": [{"t": 0, "eye": [x,y,z], "target": [x,y,z], "up": [x,y,z],
/// "fov_deg": 60}, …]}. t in seconds; fps, up and fov_deg may be left out (30, +y, 60); other keys are an
/// error.

#include <filesystem>
#include <string>
#include <string_view>

#include "ooc/result.h"
#include "runtime/flight.h"

namespace cuesta {

inline constexpr std::uint64_t max_flight_file_bytes = 64ull << 20;
inline constexpr double max_flight_frames = 1e7;

/// @param file  name for messages.
/// @error corrupt with the line for what is not JSON; invalid_input with the line of the keyframe (or its
/// number
///        where a file puts several on a line) for what is not a flight: every invariant of Flight is
///        checked.
Result<Flight> parse_flight(std::string_view text, const std::string& file);

/// @error not_found, io; out_of_budget above max_flight_file_bytes; as parse_flight.
Result<Flight> read_flight(const std::filesystem::path& path);

/// One keyframe per line; numbers have the digits that bring back the same double.
std::string flight_text(const Flight& flight);

/// To a temporary name that is then renamed.  @error io.
Result<void> write_flight(const std::filesystem::path& path, const Flight& flight);

}  // namespace cuesta
