#pragma once
/// A whole file as read-only memory, mapped: pages come in as they are touched, count as resident memory of
/// the process, and stay until they are released (map_window.h does that for readers).

#include <cstdint>
#include <filesystem>
#include <span>

#include "ooc/map_guard.h"
#include "ooc/result.h"

struct stat;

namespace cuesta {

/// Owns the map. From a page on that another program has cut off the file since it was mapped, or that the
/// disk cannot read, bytes() are zeros (map_guard.h), and check_unchanged() is an error from then on: ask it
/// before anything that was read is believed. Use it for inputs that belong to the user, not for files that
/// something is writing. Beside resident pages a map costs page tables: 2 MiB per GiB touched.
class MappedFile {
 public:
  /// What a fault maps around the page that was touched, at most: Linux from 6.18 on maps whole large folios
  /// of the page cache, before that 64 KiB.
  static constexpr std::size_t fault_bytes = std::size_t{2} << 20;

  /// @error not_found; io, also for a folder or a device. An empty file is an empty span.
  static Result<MappedFile> open(const std::filesystem::path& path);
  /// The file behind an open descriptor, which stays open and the caller's. @param path for messages.
  static Result<MappedFile> map(int descriptor, const std::filesystem::path& path);
  MappedFile() = default;
  MappedFile(MappedFile&& other) noexcept;
  MappedFile& operator=(MappedFile&& other) noexcept;
  ~MappedFile();

  std::span<const char> bytes() const { return {data_, size_}; }
  bool contains(const char* at) const { return at >= data_ && at < data_ + size_; }
  /// Tells the kernel that the file is read from front to back.
  void advise_sequential() const;
  /// Lets go of the pages from `begin` to `end` and of fault_bytes on both sides, which come in with them;
  /// pages come back when touched. @pre begin and end point into bytes(), or to its end. @cost a system call.
  void release(const char* begin, const char* end) const;
  /// Copies without touching the map, which would bring in more. @pre all of it is in bytes().
  /// @error io. Not possible after close_descriptor().
  Result<void> read(std::uint64_t offset, std::span<char> into) const;
  /// A process has few descriptors: for whoever opens many files. The map stays.
  void close_descriptor();
  /// A file put in its place under the name is no change: the map shows the old one. @error io: bytes() are
  /// not what is in the file; or, of a file that was opened by name, it was written to, cut or made longer
  /// since it was mapped. @cost a system call.
  Result<void> check_unchanged() const;
  /// Whether zeros were read in place of what is in the file.
  bool has_faulted() const { return guard_.has_faulted(); }

 private:
  /// Which file it was, how long, and when last written.
  struct Stamp {
    std::uint64_t device = 0, node = 0, size = 0;
    std::int64_t seconds = 0, nanoseconds = 0;
    bool operator==(const Stamp&) const = default;
  };
  static Stamp stamp_of(const struct ::stat& info);

  const char* data_ = nullptr;
  std::size_t size_ = 0;
  int descriptor_ = -1;  ///< a copy
  Stamp stamp_;
  std::filesystem::path path_;
  bool is_named_ = false;  ///< opened by name: path_ leads to it, or did
  MapGuard guard_;
};

}  // namespace cuesta
