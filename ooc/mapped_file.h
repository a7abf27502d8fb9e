#pragma once
/// A whole file as read-only memory, mapped: pages come in as they are touched and cost no budget.

#include <cstdint>
#include <filesystem>
#include <span>

#include "ooc/result.h"

namespace cuesta {

/// Owns the map. A file that another program truncates while it is mapped ends this process with SIGBUS:
/// use it for inputs that belong to the user, not for files that something is writing.
class MappedFile {
 public:
  /// @error not_found; io, also for a folder or a device. An empty file is an empty span.
  static Result<MappedFile> open(const std::filesystem::path& path);
  /// The file behind an open descriptor, which stays open and the caller's. @param path for messages.
  static Result<MappedFile> map(int descriptor, const std::filesystem::path& path);
  MappedFile() = default;
  MappedFile(MappedFile&& other) noexcept;
  MappedFile& operator=(MappedFile&& other) noexcept;
  ~MappedFile();

  std::span<const char> bytes() const { return {data_, size_}; }
  /// Tells the kernel that the file is read from front to back.
  void advise_sequential() const;

 private:
  const char* data_ = nullptr;
  std::size_t size_ = 0;
};

}  // namespace cuesta
