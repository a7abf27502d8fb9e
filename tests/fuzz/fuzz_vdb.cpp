/// Volumes through OpenVDB, which reads files, not bytes: each input is one in /dev/shm. The library itself
/// is not instrumented, so start from good files.

#include <unistd.h>

#include <cstdio>

#include "tests/fuzz/fuzz_reader.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace cuesta;
  static const std::string path = "/dev/shm/cuesta-fuzz-" + std::to_string(::getpid()) + ".vdb";
  // A new file each time: maps of the one before may still be there.
  ::unlink(path.c_str());
  std::FILE* file = std::fopen(path.c_str(), "wb");
  if (!file || (size > 0 && std::fwrite(data, size, 1, file) != 1)) std::abort();
  std::fclose(file);
  return fuzz::run(read_vdb, data, size, path);
}
