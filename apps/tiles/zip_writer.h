#pragma once
/// Zip archives of stored files, with 64-bit offsets where they are needed.
/// Source: PKWARE, ".ZIP File Format Specification" (APPNOTE) 6.3.9, §4.3 and §4.5.3.

#include <span>
#include <string>
#include <vector>

#include "ooc/atomic_file.h"

namespace cuesta::tiles {

/// 60 bytes per file are kept until the end. Files have the date 1980-01-01, so that archives of the same
/// files are the same bytes.
class ZipWriter {
 public:
  struct Entry {
    std::string name;
    std::uint64_t offset;  ///< of its local header
    std::uint32_t bytes, crc;
  };

  static Result<ZipWriter> create(const std::filesystem::path& path);

  /// @pre no file of that name yet, plain ASCII of less than 2^16 bytes.
  /// @error io; invalid_input from 4 GiB on.
  Result<void> add(const std::string& name, std::span<const std::byte> bytes);
  std::span<const Entry> entries() const { return entries_; }
  /// Writes the directory; the archive then has its name.
  Result<void> commit();

 private:
  explicit ZipWriter(AtomicFile file) : file_(std::move(file)) {}

  AtomicFile file_;
  std::vector<Entry> entries_;
};

}  // namespace cuesta::tiles
