#pragma once
/// Reads here and there in a large file through little memory.

#include <algorithm>
#include <cstdint>
#include <cstring>
#include <functional>
#include <memory>
#include <span>
#include <vector>

#include "ooc/result.h"

namespace cuesta {

/// Pages of page_bytes, each in its one place of the cache: neighbours never push each other out. Unlike a
/// map, of which a kernel keeps up to 2 MiB around what was touched, it holds exactly `places` pages.
class CachedFile {
 public:
  /// Reads all of the bytes at an offset; never beyond `file_bytes`.
  using ReadAt = std::function<Result<void>(std::uint64_t offset, std::span<char> bytes)>;
  static constexpr std::size_t default_page_bytes = std::size_t{1} << 12;

  CachedFile(ReadAt read_at, std::size_t page_bytes, std::uint64_t places);

  /// How much of the file there is; it may grow.
  void set_bytes(std::uint64_t file_bytes) { file_bytes_ = file_bytes; }
  /// @pre the page begins before the file's end. @return page_bytes, or up to the end; valid until the next
  /// call.
  Result<const char*> page(std::uint64_t number) {
    const std::size_t place = static_cast<std::size_t>(number % held_.size());
    if (held_[place] != number) {
      if (auto r = load(number, place); !r) return fail(std::move(r).error());
    }
    return memory_.get() + place * page_bytes_;
  }
  /// @pre all of the bytes are in the file.
  Result<void> read(std::uint64_t offset, std::span<char> bytes) {
    const std::size_t within = static_cast<std::size_t>(offset % page_bytes_);
    if (within + bytes.size() > page_bytes_) return read_across(offset, bytes);
    const auto from = page(offset / page_bytes_);
    if (!from) return fail(from.error());
    std::memcpy(bytes.data(), *from + within, bytes.size());
    return {};
  }

 private:
  static constexpr std::uint64_t none = ~std::uint64_t{0};
  Result<void> load(std::uint64_t number, std::size_t place);
  Result<void> read_across(std::uint64_t offset, std::span<char> bytes);

  ReadAt read_at_;
  std::size_t page_bytes_;
  std::uint64_t file_bytes_ = 0;
  std::unique_ptr<char[]> memory_;
  std::vector<std::uint64_t> held_;  ///< number of the page in each place
};

}  // namespace cuesta
