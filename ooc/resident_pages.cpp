#include "ooc/resident_pages.h"

#include <sys/mman.h>

#include <charconv>
#include <fstream>
#include <string>
#include <string_view>
#include <system_error>

namespace cuesta {
namespace {

/// A line of /proc/self/maps: "7f01c000-7f02d000 r--s 00000000 08:01 1234    /data/cloud.vdb".
struct MapLine {
  std::uintptr_t begin = 0, end = 0;
  bool is_writable = true;
};

bool parse(std::string_view line, MapLine& map) {
  const char* last = line.data() + line.size();
  const auto begin = std::from_chars(line.data(), last, map.begin, 16);
  if (begin.ec != std::errc{} || begin.ptr == last || *begin.ptr != '-') return false;
  const auto end = std::from_chars(begin.ptr + 1, last, map.end, 16);
  if (end.ec != std::errc{} || last - end.ptr < 5) return false;
  map.is_writable = end.ptr[2] == 'w';
  return true;
}

}  // namespace

void forget_resident_pages(const std::filesystem::path& path) {
  std::error_code failed;
  const std::string name = " " + std::filesystem::canonical(path, failed).string();
  if (failed) return;
  std::ifstream maps("/proc/self/maps");
  for (std::string line; std::getline(maps, line);) {
    MapLine map;
    if (!line.ends_with(name) || !parse(line, map) || map.is_writable) continue;
    // Only for maps that nobody writes: a written private page would be lost.
    ::madvise(reinterpret_cast<void*>(map.begin), map.end - map.begin, MADV_DONTNEED);
  }
}

}  // namespace cuesta
