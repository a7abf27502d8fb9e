#include "ooc/atomic_file.h"

#include <fcntl.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>

#include "ooc/check.h"

namespace cuesta {
namespace {

std::filesystem::path part_of(const std::filesystem::path& path) {
  std::filesystem::path part = path;
  part += ".part";
  return part;
}

/// Makes the new name durable; a file system that cannot is no reason to fail.
void sync_folder(const std::filesystem::path& path) {
  const std::filesystem::path folder = path.has_parent_path() ? path.parent_path() : ".";
  const int descriptor = ::open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  if (descriptor < 0) return;
  ::fsync(descriptor);
  ::close(descriptor);
}

tl::unexpected<Error> os_error(const std::filesystem::path& path, const char* what) {
  return fail(errno == ENOENT ? ErrorCode::not_found : ErrorCode::io, path.string(), "",
              std::string(what) + ": " + std::strerror(errno));
}

}  // namespace

Result<AtomicFile> AtomicFile::create(const std::filesystem::path& path) {
  AtomicFile file;
  file.path_ = path;
  file.descriptor_ = ::open(part_of(path).c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0644);
  if (file.descriptor_ < 0) return os_error(path, "cannot create the file");
  return file;
}

AtomicFile::AtomicFile(AtomicFile&& other) noexcept
    : path_(std::move(other.path_)),
      descriptor_(std::exchange(other.descriptor_, -1)),
      written_(other.written_) {}

AtomicFile& AtomicFile::operator=(AtomicFile&& other) noexcept {
  std::swap(path_, other.path_);
  std::swap(descriptor_, other.descriptor_);
  std::swap(written_, other.written_);
  return *this;
}

AtomicFile::~AtomicFile() {
  if (descriptor_ < 0) return;
  ::close(descriptor_);
  ::unlink(part_of(path_).c_str());
}

Result<void> AtomicFile::write(std::span<const std::byte> bytes) {
  CUESTA_CHECK(descriptor_ >= 0);
  while (!bytes.empty()) {
    const ssize_t n = ::write(descriptor_, bytes.data(), bytes.size());
    if (n < 0 && errno == EINTR) continue;
    if (n < 0) return os_error(path_, "cannot write");
    written_ += static_cast<std::uint64_t>(n);
    bytes = bytes.subspan(static_cast<std::size_t>(n));
  }
  return {};
}

Result<void> AtomicFile::rewrite(std::uint64_t offset, std::span<const std::byte> bytes) {
  CUESTA_CHECK(descriptor_ >= 0);
  CUESTA_CHECK(offset + bytes.size() <= written_, offset, bytes.size(), written_);
  while (!bytes.empty()) {
    const ssize_t n = ::pwrite(descriptor_, bytes.data(), bytes.size(), static_cast<off_t>(offset));
    if (n < 0 && errno == EINTR) continue;
    if (n < 0) return os_error(path_, "cannot write");
    offset += static_cast<std::uint64_t>(n);
    bytes = bytes.subspan(static_cast<std::size_t>(n));
  }
  return {};
}

Result<void> AtomicFile::commit() {
  CUESTA_CHECK(descriptor_ >= 0);
  if (::fsync(descriptor_) != 0) return os_error(path_, "cannot sync");
  // The descriptor stays open until the name is there: what fails before that leaves no part behind.
  if (::rename(part_of(path_).c_str(), path_.c_str()) != 0)
    return os_error(path_, "cannot rename into place");
  if (::close(std::exchange(descriptor_, -1)) != 0) return os_error(path_, "cannot close");
  sync_folder(path_);
  return {};
}

}  // namespace cuesta
