#pragma once
/// The .cuesta container: a header at a known place, checksummed aligned blocks, and a directory, one of the
/// blocks, that the header points at. What the blocks and the directory mean is the business of hierarchy/.
///
/// Layout, little-endian (docs/format.md):
///   0  8 bytes "CUESTA\r\n"   8  u32 version   12 u32 header bytes (64)   16 u64 directory offset
///   24 u64 directory bytes    32 u64 directory XXH3     40 u64 file bytes    48 u64 what is in it
///   56 u64 XXH3 of bytes 0…55
///   64 … blocks, each at a multiple of 64; the directory of a surface comes last, that of a scene first.

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <span>
#include <vector>

#include "ooc/atomic_file.h"
#include "ooc/byte_source.h"
#include "ooc/result.h"

namespace cuesta {

/// What the directory describes. Values are those of the header.
enum class ContainerKind : std::uint64_t { surface = 0, scene = 1 };

/// Of each kind: readers of version 1 know surfaces only.
constexpr std::uint32_t container_version(ContainerKind kind) {
  return kind == ContainerKind::scene ? 2 : 1;
}
inline constexpr std::uint64_t container_alignment = 64;
inline constexpr std::uint64_t container_header_bytes = 64;

/// Where the next block begins.
constexpr std::uint64_t container_aligned(std::uint64_t offset) {
  return (offset + container_alignment - 1) / container_alignment * container_alignment;
}

/// Where a block lies and what its bytes must hash to.
struct BlockRef {
  std::uint64_t offset = 0;
  std::uint64_t bytes = 0;
  std::uint64_t checksum = 0;  ///< XXH3, 64 bits

  friend bool operator==(const BlockRef&, const BlockRef&) = default;
};

class ContainerWriter {
 public:
  static Result<ContainerWriter> create(const std::filesystem::path& path,
                                        ContainerKind kind = ContainerKind::surface);
  /// Goes on with a surface after the block that ends at byte `end`, in what an interrupted writer with
  /// keep_part() left.
  /// @error not_found, io; corrupt if there is less
  static Result<ContainerWriter> resume(const std::filesystem::path& path, std::uint64_t end);
  /// What is unfinished when this goes stays for resume().
  void keep_part() { file_.keep_part(); }
  Result<BlockRef> append(std::span<const std::byte> block);
  /// Writes the directory as the last block, then finish(its place).
  Result<void> finish(std::span<const std::byte> directory);
  /// Writes the header, syncs, and gives the file its name. @param directory  a block that was appended
  Result<void> finish(const BlockRef& directory);
  std::uint64_t bytes_written() const { return file_.bytes_written(); }

 private:
  ContainerWriter(AtomicFile file, ContainerKind kind) : file_(std::move(file)), kind_(kind) {}
  Result<void> pad();
  AtomicFile file_;
  ContainerKind kind_;
};

/// Concurrent reads are safe where the source's are: every read is a positioned one.
class ContainerReader {
 public:
  /// A scene that was cut off is opened, too; its blocks beyond the end are errors.
  /// @error not_found, io; corrupt (not a .cuesta file, a truncated surface, damaged header);
  /// unsupported_version; invalid_input: it is of the other kind.
  static Result<ContainerReader> open(const std::filesystem::path& path, ContainerKind wanted);
  /// @param source  shared with whoever delivers its bytes.   @error as above, of the source.
  static Result<ContainerReader> open(std::shared_ptr<const ByteSource> source, ContainerKind wanted);
  /// What the file says that it holds; only its header is read. @error as open()
  static Result<ContainerKind> kind_of(const std::filesystem::path& path);

  /// Reads and checks a block. @error of the source; corrupt when it lies outside the file or its checksum
  /// differs.
  Result<std::vector<std::byte>> read(const BlockRef& block) const;
  const BlockRef& directory() const { return directory_; }
  std::uint64_t file_bytes() const { return source_->size(); }
  /// Bytes that the whole file has.
  std::uint64_t whole_bytes() const { return whole_bytes_; }
  const std::filesystem::path& path() const { return source_->path(); }

 private:
  explicit ContainerReader(std::shared_ptr<const ByteSource> source) : source_(std::move(source)) {}
  Result<ContainerKind> read_header();
  std::shared_ptr<const ByteSource> source_;
  BlockRef directory_;
  std::uint64_t whole_bytes_ = 0;
};

}  // namespace cuesta
