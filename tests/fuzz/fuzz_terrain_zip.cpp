/// Compressed rasters: gzip, Zstandard, zip. Needs a file with a name, in /dev/shm.
#include <unistd.h>

#include <cstdio>

#include "tests/fuzz/fuzz_terrain.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace cuesta;
  static const std::string path = "/dev/shm/cuesta-fuzz-" + std::to_string(::getpid()) + "-N01E001.hgt.zip";
  ::unlink(path.c_str());
  std::FILE* out = std::fopen(path.c_str(), "wb");
  if (!out || (size > 0 && std::fwrite(data, size, 1, out) != 1)) std::abort();
  std::fclose(out);
  const auto file = open_raster_file(path, "/dev/shm");
  if (!file && file.error().message.empty()) std::abort();
  return 0;
}
