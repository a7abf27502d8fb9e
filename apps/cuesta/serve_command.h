#pragma once
/// cuesta serve: .cuesta files over HTTP.

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "ooc/result.h"

namespace cuesta::app {

struct ServeSettings {
  std::vector<std::filesystem::path> paths;  ///< .cuesta files, and folders of them
  std::string bind = "127.0.0.1";
  std::uint16_t port = 8080;  ///< 0: any that is free, which is told
  std::uint32_t threads = 0;  ///< 0: as many as the machine has, at most 16
  std::uint32_t connections = 1024;
  std::filesystem::path page;  ///< folder with the web page; empty: none
  bool thumbnails = true;
  std::uint32_t tile_threads = 2;                   ///< that make tiles; 0: there are none
  std::uint64_t tile_cache_bytes = 512ull << 20;    ///< of resident pages, for each
  std::uint64_t tile_memory_bytes = 128ull << 20;   ///< of tiles that were made
  std::uint32_t sessions = 256;                     ///< that are open at once; 0: none are taken
  std::uint64_t session_cache_bytes = 64ull << 20;  ///< of resident pages, for each
  std::uint64_t session_memory_bytes = 0;           ///< of all of them; 0: half of the machine's
};

/// Serves until SIGINT or SIGTERM, then ends the responses under way, within ten seconds.
/// @error not_found, invalid_input of a path; io: it cannot listen.
Result<void> run_serve(const ServeSettings& settings);

}  // namespace cuesta::app
