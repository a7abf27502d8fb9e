#include "apps/cuesta/huge_pages.h"

#include <unistd.h>

#include <cstdint>
#include <cstdlib>
#include <filesystem>
#include <system_error>

namespace cuesta::app {

#if defined(__GLIBC__) && !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)
namespace {

constexpr const char* variable = "GLIBC_TUNABLES";
constexpr std::uintmax_t large_file = 1u << 18;

bool is_large(const char* argument) {
  std::error_code error;
  const std::filesystem::path path = argument;
  return std::filesystem::is_directory(path, error) ||
         (std::filesystem::is_regular_file(path, error) &&
          std::filesystem::file_size(path, error) >= large_file);
}

}  // namespace

void use_huge_pages(char** argv) {
  if (std::getenv(variable)) return;
  char** argument = argv + 1;
  while (*argument && !is_large(*argument)) ++argument;
  if (!*argument) return;
  // By its own path: as /proc/self/exe the process would be called "exe".
  std::error_code error;
  const std::filesystem::path self = std::filesystem::read_symlink("/proc/self/exe", error);
  if (error || ::setenv(variable, "glibc.malloc.hugetlb=1", 1) != 0) return;
  ::execv(self.c_str(), argv);
}
#else
void use_huge_pages(char**) {}
#endif

}  // namespace cuesta::app
