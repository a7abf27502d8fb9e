#include "ooc/cached_file.h"

#include <utility>

namespace cuesta {

CachedFile::CachedFile(ReadAt read_at, std::size_t page_bytes, std::uint64_t places)
    : read_at_(std::move(read_at)),
      page_bytes_(page_bytes),
      memory_(std::make_unique_for_overwrite<char[]>(places * page_bytes)),
      held_(places, none) {}

Result<void> CachedFile::load(std::uint64_t number, std::size_t place) {
  held_[place] = none;
  const std::uint64_t offset = number * page_bytes_;
  const std::size_t bytes =
      static_cast<std::size_t>(std::min<std::uint64_t>(page_bytes_, file_bytes_ - offset));
  if (auto r = read_at_(offset, {memory_.get() + place * page_bytes_, bytes}); !r) return r;
  held_[place] = number;
  return {};
}

Result<void> CachedFile::read_across(std::uint64_t offset, std::span<char> bytes) {
  while (!bytes.empty()) {
    const std::size_t left_in_page = page_bytes_ - static_cast<std::size_t>(offset % page_bytes_);
    const std::size_t count = std::min(bytes.size(), left_in_page);
    if (auto r = read(offset, bytes.first(count)); !r) return r;
    offset += count;
    bytes = bytes.subspan(count);
  }
  return {};
}

}  // namespace cuesta
