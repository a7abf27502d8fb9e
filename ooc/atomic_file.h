#pragma once
/// A file that appears under its name whole or not at all: temporary name, fsync, rename.

#include <cstdint>
#include <filesystem>
#include <memory>
#include <span>

#include "ooc/file_handle.h"
#include "ooc/result.h"

namespace cuesta {

/// Sequential writer to `<path>.part`; `commit()` syncs and renames it. Destroyed without commit: the part is
/// removed, unless it is to be resumed.
class AtomicFile {
 public:
  static Result<AtomicFile> create(const std::filesystem::path& path);
  /// Goes on with the first `bytes` bytes of a part that keep_part() left.
  /// @error not_found; corrupt if it is shorter
  static Result<AtomicFile> resume(const std::filesystem::path& path, std::uint64_t bytes);
  AtomicFile(AtomicFile&&) noexcept = default;
  AtomicFile& operator=(AtomicFile&&) noexcept = default;
  ~AtomicFile();

  Result<void> write(std::span<const std::byte> bytes);
  /// Overwrites bytes that were written before.
  Result<void> rewrite(std::uint64_t offset, std::span<const std::byte> bytes);
  std::uint64_t bytes_written() const { return written_; }
  /// Without commit, the part stays for resume().
  void keep_part() { keep_part_ = true; }
  Result<void> commit();

 private:
  AtomicFile(std::filesystem::path path, FileHandle part, std::uint64_t written)
      : path_(std::move(path)), part_(std::move(part)), written_(written) {}
  std::filesystem::path path_;
  FileHandle part_;
  std::uint64_t written_ = 0;
  bool keep_part_ = false;
};

}  // namespace cuesta
