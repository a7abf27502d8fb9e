#pragma once
/// cuesta verify: holds a .cuesta file to everything that can be checked from the file alone.

#include <filesystem>

#include "ooc/result.h"

namespace cuesta::app {

struct VerifySettings {
  std::filesystem::path file;
  bool quick = false;  ///< no sample cuts: bytes, directory, sources, and each page's script only
  bool json = false;
  bool quiet = false;
};

/// Prints the report. @error as CuestaFile::open; corrupt when something was found; cancelled.
Result<void> run_verify(const VerifySettings& settings);

}  // namespace cuesta::app
