#pragma once
/// A file without a name for data that would not fit in memory: gone when it is closed, also after a crash.

#include <cstdint>
#include <filesystem>
#include <span>

#include "ooc/mapped_file.h"
#include "ooc/result.h"

namespace cuesta {

/// `folder`, or where that is empty TMPDIR, or else /tmp. Beware: /tmp may be memory.
std::filesystem::path temp_folder(const std::filesystem::path& folder);

/// Written in order, read back as a map or piece by piece. Leaves spare_bytes of the disk free, as a full
/// disk hurts every program on it.
class TempFile {
 public:
  static constexpr std::uint64_t spare_bytes = std::uint64_t{64} << 20;

  /// @param folder  as for temp_folder(). @error not_found, io.
  static Result<TempFile> create(const std::filesystem::path& folder);
  TempFile(TempFile&& other) noexcept;
  TempFile& operator=(TempFile&& other) noexcept;
  ~TempFile();

  /// Call before writing what is known to come. @error out_of_budget: the disk has no room for it.
  Result<void> expect(std::uint64_t bytes) const;
  /// @error out_of_budget: the disk is full; io.
  Result<void> write(std::span<const char> bytes);
  /// What was written at `offset`, into all of `bytes`. @error io, also beyond what was written.
  Result<void> read(std::uint64_t offset, std::span<char> bytes) const;
  /// What was written, as memory. The file lives as long as the map.
  Result<MappedFile> map() const;
  std::uint64_t bytes_written() const { return written_; }

 private:
  TempFile() = default;
  std::filesystem::path folder_;
  int descriptor_ = -1;
  std::uint64_t written_ = 0;
  std::uint64_t checked_ = 0;  ///< room was seen for the file to grow to this many bytes
};

}  // namespace cuesta
