#pragma once
/// cuesta info: what is in a .cuesta file, from its directory alone.

#include <filesystem>

#include "ooc/result.h"

namespace cuesta::app {

struct InfoSettings {
  std::filesystem::path file;
  bool json = false;
  bool pages = false;  ///< also every page
};

/// @error as CuestaFile::open.
Result<void> run_info(const InfoSettings& settings);

}  // namespace cuesta::app
