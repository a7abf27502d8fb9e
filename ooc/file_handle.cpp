#include "ooc/file_handle.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <atomic>
#include <cerrno>
#include <cstring>
#include <string>
#include <utility>

namespace cuesta {
namespace {

std::atomic<FileFault> file_fault{nullptr};

tl::unexpected<Error> os_error(const std::filesystem::path& path, const char* what, std::string place = "") {
  return fail(code_of_errno(errno), path.string(), std::move(place),
              std::string(what) + ": " + std::strerror(errno));
}

std::string at_byte(std::uint64_t offset) {
  return "byte " + std::to_string(offset);
}

/// True if the hook wants this access to fail; errno says how.
bool is_failed_by_hook(bool is_write, const std::filesystem::path& path, std::uint64_t offset,
                       std::uint64_t bytes) {
  const FileFault fault = file_fault.load(std::memory_order_relaxed);
  const int number = fault ? fault(is_write, path, offset, bytes) : 0;
  if (number != 0) errno = number;
  return number != 0;
}

}  // namespace

void set_file_fault(FileFault fault) {
  file_fault.store(fault);
}

ErrorCode code_of_errno(int number) {
  switch (number) {
    case ENOENT:
    case ENOTDIR:
      return ErrorCode::not_found;
    case ENOSPC:
    case EDQUOT:
    case EFBIG:
      return ErrorCode::out_of_budget;
    default:
      return ErrorCode::io;
  }
}

Result<FileHandle> FileHandle::create(const std::filesystem::path& path) {
  FileHandle file;
  file.path_ = path;
  file.descriptor_ = ::open(path.c_str(), O_RDWR | O_CREAT | O_TRUNC | O_CLOEXEC, 0644);
  if (file.descriptor_ < 0) return os_error(path, "cannot create the file");
  return file;
}

Result<FileHandle> FileHandle::open(const std::filesystem::path& path) {
  FileHandle file;
  file.path_ = path;
  file.descriptor_ = ::open(path.c_str(), O_RDWR | O_CLOEXEC);
  if (file.descriptor_ < 0) return os_error(path, "cannot open the file");
  return file;
}

FileHandle::FileHandle(FileHandle&& other) noexcept
    : path_(std::move(other.path_)), descriptor_(std::exchange(other.descriptor_, -1)) {}

FileHandle& FileHandle::operator=(FileHandle&& other) noexcept {
  std::swap(path_, other.path_);
  std::swap(descriptor_, other.descriptor_);
  return *this;
}

FileHandle::~FileHandle() {
  if (descriptor_ >= 0) ::close(descriptor_);
}

Result<void> FileHandle::read_at(std::uint64_t offset, std::span<std::byte> bytes) const {
  while (!bytes.empty()) {
    ssize_t n = -1;
    if (!is_failed_by_hook(false, path_, offset, bytes.size()))
      n = ::pread(descriptor_, bytes.data(), bytes.size(), static_cast<off_t>(offset));
    if (n < 0 && errno == EINTR) continue;
    if (n < 0) return os_error(path_, "cannot read", at_byte(offset));
    if (n == 0)
      return fail(ErrorCode::corrupt, path_.string(), at_byte(offset),
                  "expected " + std::to_string(bytes.size()) + " more bytes, found the end of the file");
    offset += static_cast<std::uint64_t>(n);
    bytes = bytes.subspan(static_cast<std::size_t>(n));
  }
  return {};
}

Result<void> FileHandle::write_at(std::uint64_t offset, std::span<const std::byte> bytes) const {
  while (!bytes.empty()) {
    ssize_t n = -1;
    if (!is_failed_by_hook(true, path_, offset, bytes.size()))
      n = ::pwrite(descriptor_, bytes.data(), bytes.size(), static_cast<off_t>(offset));
    if (n < 0 && errno == EINTR) continue;
    if (n < 0) return os_error(path_, "cannot write", at_byte(offset));
    offset += static_cast<std::uint64_t>(n);
    bytes = bytes.subspan(static_cast<std::size_t>(n));
  }
  return {};
}

Result<void> FileHandle::resize(std::uint64_t bytes) const {
  if (::ftruncate(descriptor_, static_cast<off_t>(bytes)) != 0) return os_error(path_, "cannot resize");
  return {};
}

Result<std::uint64_t> FileHandle::size() const {
  struct stat status {};
  if (::fstat(descriptor_, &status) != 0) return os_error(path_, "cannot look up its size");
  return static_cast<std::uint64_t>(status.st_size);
}

Result<void> FileHandle::sync() const {
  if (::fdatasync(descriptor_) != 0) return os_error(path_, "cannot sync");
  return {};
}

void FileHandle::discard(std::uint64_t offset, std::uint64_t bytes) const {
  ::fallocate(descriptor_, FALLOC_FL_PUNCH_HOLE | FALLOC_FL_KEEP_SIZE, static_cast<off_t>(offset),
              static_cast<off_t>(bytes));
}

void FileHandle::prefetch(std::uint64_t offset, std::uint64_t bytes) const {
  ::posix_fadvise(descriptor_, static_cast<off_t>(offset), static_cast<off_t>(bytes), POSIX_FADV_WILLNEED);
}

}  // namespace cuesta
