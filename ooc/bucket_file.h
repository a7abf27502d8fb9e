#pragma once
/// Many append-only streams in one file: what is written in any order is read back bucket by bucket. The
/// out-of-core build's only way to regroup data that do not fit in memory.

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <memory>
#include <mutex>
#include <span>
#include <vector>

#include "ooc/file_handle.h"
#include "ooc/result.h"

namespace cuesta {

/// Records of different writers come in no particular order: a reader that needs one sorts them.
class BucketFile {
 public:
  /// A run of a bucket's bytes in the file: one for each time that a writer's buffer was full. In memory, 16
  /// bytes each.
  struct Extent {
    std::uint64_t offset = 0;
    std::uint32_t bytes = 0;
  };

  /// Makes the file. Buckets are made as they are named.
  static Result<BucketFile> create(const std::filesystem::path& path);
  /// Opens a file again that was complete when encode_index() was called.
  /// @error not_found, io; corrupt
  static Result<BucketFile> open(const std::filesystem::path& path, std::span<const std::byte> index);
  std::vector<std::byte> encode_index() const;

  /// A bucket's bytes, in the order in which they reached the file.
  Result<std::vector<std::byte>> read(std::uint32_t bucket) const;
  std::uint64_t bytes(std::uint32_t bucket) const;
  /// A bucket's pieces, each of whole records, for those who read them in parallel.
  std::size_t piece_count(std::uint32_t bucket) const {
    return bucket < extents_.size() ? extents_[bucket].size() : 0;
  }
  Result<std::vector<std::byte>> read_piece(std::uint32_t bucket, std::size_t piece) const;
  std::uint64_t total_bytes() const { return end_->load(); }
  std::uint32_t bucket_count() const { return static_cast<std::uint32_t>(extents_.size()); }
  /// Gives a bucket's disk space back; of pieces smaller than a block of the file system, nothing.
  void discard(std::uint32_t bucket) const;
  Result<void> sync() const { return file_.sync(); }

  /// Appends for one thread. Holds `buffer_bytes` for each bucket that it has met, until it goes.
  class Writer {
   public:
    Writer(BucketFile& file, std::uint32_t buffer_bytes) : file_(file), buffer_bytes_(buffer_bytes) {}
    /// A record stays in one piece. @pre no longer than the buffer. @error out_of_budget (disk full), io
    Result<void> append(std::uint32_t bucket, std::span<const std::byte> record);
    template <class T>
    Result<void> append(std::uint32_t bucket, const T& record) {
      return append(bucket, std::as_bytes(std::span(&record, 1)));
    }
    /// Writes what is buffered. A writer that goes without it loses that.
    Result<void> flush();

   private:
    Result<void> flush(std::uint32_t bucket);
    BucketFile& file_;
    std::uint32_t buffer_bytes_;
    std::vector<std::vector<std::byte>> buffers_;
  };

 private:
  Result<void> add(std::uint32_t bucket, std::span<const std::byte> bytes);

  FileHandle file_;
  std::vector<std::vector<Extent>> extents_;
  std::unique_ptr<std::atomic<std::uint64_t>> end_ = std::make_unique<std::atomic<std::uint64_t>>(0);
  std::unique_ptr<std::mutex> mutex_ = std::make_unique<std::mutex>();
};

/// Bytes of a bucket as the records that were appended. @pre written as records of this type
template <class T>
std::vector<T> records_of(std::span<const std::byte> bytes) {
  std::vector<T> records(bytes.size() / sizeof(T));
  if (!records.empty()) std::memcpy(records.data(), bytes.data(), records.size() * sizeof(T));
  return records;
}

}  // namespace cuesta
