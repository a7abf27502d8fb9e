#pragma once
/// cuesta sample: heights of a terrain at places, from the finest data.

#include <filesystem>
#include <string>
#include <vector>

#include "ooc/result.h"

namespace cuesta::app {

struct SampleSettings {
  std::filesystem::path file;
  std::vector<std::string> points;  ///< numbers, in pairs
  std::filesystem::path from;       ///< file with a pair a line; "-": standard input
  bool xy = false;                  ///< pairs are x and y of `crs`; else latitude and longitude
  std::string crs;                  ///< "EPSG:2056"; empty: the file's own projection
  bool json = false;
};

/// A line for each point on stdout, also where there is no data.
/// @error of reading; invalid_input: a file that is no terrain, or points that are none.
Result<void> run_sample(const SampleSettings& settings);

}  // namespace cuesta::app
