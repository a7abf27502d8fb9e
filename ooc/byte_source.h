#pragma once
/// Where the bytes of an open file come from: a local file, or whoever delivers them (delivered_bytes.h).

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <span>

#include "ooc/result.h"

namespace cuesta {

/// Threads: const calls are concurrent, but where a source says otherwise.
class ByteSource {
 public:
  ByteSource(std::filesystem::path path, std::uint64_t size) : path_(std::move(path)), size_(size) {}
  virtual ~ByteSource() = default;
  ByteSource(const ByteSource&) = delete;
  ByteSource& operator=(const ByteSource&) = delete;

  /// Fills `bytes` from `offset` on. @pre the range lies within size().
  /// @error io; corrupt (place: the byte) when the file ends before the range does.
  virtual Result<void> read_at(std::uint64_t offset, std::span<std::byte> bytes) const = 0;
  std::uint64_t size() const { return size_; }
  /// As the user gave it, for messages; of what is no local file, its address.
  const std::filesystem::path& path() const { return path_; }

 private:
  std::filesystem::path path_;
  std::uint64_t size_;
};

/// A regular file, read where it lies. @error not_found, io; invalid_input for what is no regular file.
Result<std::unique_ptr<ByteSource>> open_local_file(const std::filesystem::path& path);

/// "byte 4096": a place in messages.
std::string at_byte(std::uint64_t offset);

}  // namespace cuesta
