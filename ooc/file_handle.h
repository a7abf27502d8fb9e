#pragma once
/// An open file: positioned reads and writes of whole ranges, errors with name and place. Outputs and the
/// work files of builds go through here, so one hook can make any of them fail (tests of full and failing
/// disks). Only TempFile and the journal do not.

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <span>

#include "ooc/result.h"

namespace cuesta {

/// Owns the descriptor. Reads and writes of different ranges may run concurrently.
class FileHandle {
 public:
  /// Opens for reading and writing; makes the file, or empties one that is there.
  static Result<FileHandle> create(const std::filesystem::path& path);
  /// Opens a file that is there, for reading and writing. @error not_found, io
  static Result<FileHandle> open(const std::filesystem::path& path);
  FileHandle() = default;
  FileHandle(FileHandle&& other) noexcept;
  FileHandle& operator=(FileHandle&& other) noexcept;
  ~FileHandle();

  /// @error io; corrupt (place: the byte) when the file ends before the range does.
  Result<void> read_at(std::uint64_t offset, std::span<std::byte> bytes) const;
  /// @error io; out_of_budget when the disk, a quota or a limit is full.
  Result<void> write_at(std::uint64_t offset, std::span<const std::byte> bytes) const;
  /// Cuts the file off or fills it with zeros.
  Result<void> resize(std::uint64_t bytes) const;
  Result<std::uint64_t> size() const;
  /// What was written is on the disk.
  Result<void> sync() const;
  /// Gives a range's disk space back where the file system can: whole blocks of it (4 KiB, mostly) that lie
  /// in the range. The range reads as zeros then.
  void discard(std::uint64_t offset, std::uint64_t bytes) const;
  /// Asks the system to read a range ahead. Never waits.
  void prefetch(std::uint64_t offset, std::uint64_t bytes) const;
  const std::filesystem::path& path() const { return path_; }
  bool is_open() const { return descriptor_ >= 0; }

 private:
  std::filesystem::path path_;
  int descriptor_ = -1;
};

/// For tests: called before each read and write of every FileHandle; a result other than 0 is the errno that
/// it fails with. Called from many threads. Null removes it.
using FileFault = int (*)(bool is_write, const std::filesystem::path& path, std::uint64_t offset,
                          std::uint64_t bytes);
void set_file_fault(FileFault fault);

/// What a full disk, a quota or a file size limit gives is out_of_budget, a missing name not_found, else io.
ErrorCode code_of_errno(int number);

}  // namespace cuesta
