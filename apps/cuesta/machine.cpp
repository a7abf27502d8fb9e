#include "apps/cuesta/machine.h"

#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <fstream>

namespace cuesta::app {
namespace {

/// A line "Name:   123 kB" of /proc/self/status, in bytes.
std::uint64_t status_bytes(const std::string& name) {
  std::ifstream status("/proc/self/status");
  for (std::string line; std::getline(status, line);)
    if (line.starts_with(name)) return std::strtoull(line.c_str() + name.size(), nullptr, 10) << 10;
  return 0;
}

}  // namespace

std::uint64_t physical_memory_bytes() {
  std::uint64_t bytes = static_cast<std::uint64_t>(std::max(0L, sysconf(_SC_PHYS_PAGES))) *
                        static_cast<std::uint64_t>(std::max(0L, sysconf(_SC_PAGESIZE)));
  std::uint64_t limit = 0;
  if (std::ifstream("/sys/fs/cgroup/memory.max") >> limit && limit > 0) bytes = std::min(bytes, limit);
  return bytes;
}

std::uint64_t peak_resident_bytes() {
  return status_bytes("VmHWM:");
}

std::uint64_t resident_bytes() {
  return status_bytes("VmRSS:");
}

double clock_ms() {
  static const auto start = std::chrono::steady_clock::now();
  return std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start).count();
}

std::string version_number() {
  return CUESTA_VERSION;
}

std::string version_text() {
  std::string text = "cuesta " CUESTA_VERSION;
  if (const std::string commit = CUESTA_COMMIT; !commit.empty()) text += " (commit " + commit + ")";
  return text + "\ncompiler: " CUESTA_COMPILER "\nbuild: " CUESTA_BUILD;
}

}  // namespace cuesta::app
