#pragma once
/// A file that appears under its name whole or not at all: temporary name, fsync, rename.

#include <cstdint>
#include <filesystem>
#include <memory>
#include <span>

#include "ooc/result.h"

namespace cuesta {

/// Sequential writer to `<path>.part`; `commit()` syncs and renames it. Destroyed without commit: the part is
/// removed.
class AtomicFile {
 public:
  static Result<AtomicFile> create(const std::filesystem::path& path);
  AtomicFile(AtomicFile&&) noexcept;
  AtomicFile& operator=(AtomicFile&&) noexcept;
  ~AtomicFile();

  Result<void> write(std::span<const std::byte> bytes);
  /// Overwrites bytes that were written before.
  Result<void> rewrite(std::uint64_t offset, std::span<const std::byte> bytes);
  std::uint64_t bytes_written() const { return written_; }
  Result<void> commit();

 private:
  AtomicFile() = default;
  std::filesystem::path path_;
  int descriptor_ = -1;
  std::uint64_t written_ = 0;
};

}  // namespace cuesta
