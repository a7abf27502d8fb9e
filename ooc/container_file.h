#pragma once
/// The .cuesta container: a header at a known place, checksummed aligned blocks, and a directory that the
/// header points at. What the blocks and the directory mean is the business of hierarchy/.
///
/// Layout, little-endian (docs/format.md):
///   0  8 bytes "CUESTA\r\n"   8  u32 version   12 u32 header bytes (64)   16 u64 directory offset
///   24 u64 directory bytes    32 u64 directory XXH3     40 u64 file bytes    48 u64 reserved (0)
///   56 u64 XXH3 of bytes 0…55
///   64 … blocks, each at a multiple of 64; the directory comes last.

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <span>
#include <vector>

#include "ooc/atomic_file.h"
#include "ooc/result.h"

namespace cuesta {

inline constexpr std::uint32_t container_version = 1;
inline constexpr std::uint64_t container_alignment = 64;

/// Where a block lies and what its bytes must hash to.
struct BlockRef {
  std::uint64_t offset = 0;
  std::uint64_t bytes = 0;
  std::uint64_t checksum = 0;  ///< XXH3, 64 bits

  friend bool operator==(const BlockRef&, const BlockRef&) = default;
};

class ContainerWriter {
 public:
  static Result<ContainerWriter> create(const std::filesystem::path& path);
  /// Goes on after the block that ends at byte `end`, in what an interrupted writer with keep_part() left.
  /// @error not_found, io; corrupt if there is less
  static Result<ContainerWriter> resume(const std::filesystem::path& path, std::uint64_t end);
  /// What is unfinished when this goes stays for resume().
  void keep_part() { file_.keep_part(); }
  Result<BlockRef> append(std::span<const std::byte> block);
  /// Writes the directory and the header, syncs, and gives the file its name.
  Result<void> finish(std::span<const std::byte> directory);
  std::uint64_t bytes_written() const { return file_.bytes_written(); }

 private:
  explicit ContainerWriter(AtomicFile file) : file_(std::move(file)) {}
  Result<void> pad();
  AtomicFile file_;
};

/// Concurrent reads are safe: every read is a positioned one.
class ContainerReader {
 public:
  /// @error not_found, io; corrupt (not a .cuesta file, truncated, damaged header); unsupported_version.
  static Result<ContainerReader> open(const std::filesystem::path& path);
  ContainerReader(ContainerReader&&) noexcept;
  ContainerReader& operator=(ContainerReader&&) noexcept;
  ~ContainerReader();

  /// Reads and checks a block. @error io; corrupt when it lies outside the file or its checksum differs.
  Result<std::vector<std::byte>> read(const BlockRef& block) const;
  const BlockRef& directory() const { return directory_; }
  std::uint64_t file_bytes() const { return file_bytes_; }
  const std::filesystem::path& path() const { return path_; }

 private:
  ContainerReader() = default;
  std::filesystem::path path_;
  int descriptor_ = -1;
  BlockRef directory_;
  std::uint64_t file_bytes_ = 0;
};

}  // namespace cuesta
