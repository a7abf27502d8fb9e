#pragma once
/// cuesta measure: how far two surfaces are apart, as Metro reports it.

#include <cstdint>
#include <filesystem>

#include "ooc/result.h"

namespace cuesta::app {

struct MeasureSettings {
  std::filesystem::path a, b;         ///< mesh files; A is the original
  std::uint64_t samples = 1'000'000;  ///< for each direction
  std::uint64_t memory_bytes = 0;     ///< 0: three quarters of the machine's
  bool json = false;
  bool quiet = false;
};

Result<void> run_measure(const MeasureSettings& settings);

}  // namespace cuesta::app
