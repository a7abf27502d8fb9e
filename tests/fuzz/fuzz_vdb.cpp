/// Volumes through OpenVDB, which reads files, not bytes: each input is one in /dev/shm. The library itself
/// is not instrumented, so start from good files. It believes the counts of a damaged tree and the lengths of
/// its texts: minutes and gigabytes are its own, so run with -fork=1 -ignore_timeouts=1 -ignore_ooms=1
/// -timeout=5 -max_len=170000 -rss_limit_mb=4000 -malloc_limit_mb=0. Nodes that it had read when it throws
/// are lost, so leaks are not looked for.

#include <unistd.h>

#include <cstdio>
#include <new>

#include "tests/fuzz/fuzz_reader.h"

// Sizes in a damaged file are the library's to believe: as without a sanitizer, what cannot be allocated
// throws.
extern "C" const char* __asan_default_options() {
  return "allocator_may_return_null=1:alloc_dealloc_mismatch=0:detect_leaks=0:max_allocation_size_mb=300";
}
void* operator new(std::size_t bytes) {
  if (void* p = std::malloc(bytes)) return p;
  throw std::bad_alloc();
}
void* operator new[](std::size_t bytes) {
  return operator new(bytes);
}
void operator delete(void* p) noexcept {
  std::free(p);
}
void operator delete[](void* p) noexcept {
  std::free(p);
}
void operator delete(void* p, std::size_t) noexcept {
  std::free(p);
}
void operator delete[](void* p, std::size_t) noexcept {
  std::free(p);
}

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
