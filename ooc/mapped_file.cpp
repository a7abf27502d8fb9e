#include "ooc/mapped_file.h"

#include <fcntl.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <utility>

namespace cuesta {
namespace {

tl::unexpected<Error> os_error(const std::filesystem::path& path, const char* what) {
  return fail(errno == ENOENT || errno == ENOTDIR ? ErrorCode::not_found : ErrorCode::io, path.string(), "",
              std::string(what) + ": " + std::strerror(errno));
}

}  // namespace

MappedFile::Stamp MappedFile::stamp_of(const struct stat& info) {
  return {info.st_dev, info.st_ino, static_cast<std::uint64_t>(info.st_size), info.st_mtim.tv_sec,
          info.st_mtim.tv_nsec};
}

Result<MappedFile> MappedFile::open(const std::filesystem::path& path) {
  // O_NONBLOCK: opening a named pipe must not wait for a writer.
  const int descriptor = ::open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK);
  if (descriptor < 0) return os_error(path, "cannot open");
  auto file = map(descriptor, path);
  ::close(descriptor);
  if (file) file->is_named_ = true;
  return file;
}

Result<MappedFile> MappedFile::map(int descriptor, const std::filesystem::path& path) {
  MappedFile file;
  file.path_ = path;
  struct stat info {};
  if (::fstat(descriptor, &info) != 0 || !S_ISREG(info.st_mode))
    return fail(ErrorCode::io, path.string(), "", "expected a regular file");
  file.stamp_ = stamp_of(info);
  if (info.st_size > 0) {
    const std::size_t size = static_cast<std::size_t>(info.st_size);
    void* map = ::mmap(nullptr, size, PROT_READ, MAP_PRIVATE, descriptor, 0);
    if (map == MAP_FAILED) return os_error(path, "cannot map into memory");
    file.descriptor_ = ::fcntl(descriptor, F_DUPFD_CLOEXEC, 0);
    file.data_ = static_cast<const char*>(map);
    file.size_ = size;
    file.guard_ = MapGuard(map, size);
  }
  return file;
}

MappedFile::MappedFile(MappedFile&& other) noexcept
    : data_(std::exchange(other.data_, nullptr)),
      size_(std::exchange(other.size_, 0)),
      descriptor_(std::exchange(other.descriptor_, -1)),
      stamp_(other.stamp_),
      path_(std::move(other.path_)),
      is_named_(other.is_named_),
      guard_(std::move(other.guard_)) {}

MappedFile& MappedFile::operator=(MappedFile&& other) noexcept {
  std::swap(data_, other.data_);
  std::swap(size_, other.size_);
  std::swap(descriptor_, other.descriptor_);
  std::swap(stamp_, other.stamp_);
  std::swap(path_, other.path_);
  std::swap(is_named_, other.is_named_);
  std::swap(guard_, other.guard_);
  return *this;
}

MappedFile::~MappedFile() {
  close_descriptor();
  guard_ = {};
  if (data_) ::munmap(const_cast<char*>(data_), size_);
}

void MappedFile::advise_sequential() const {
  if (data_) ::madvise(const_cast<char*>(data_), size_, MADV_SEQUENTIAL);
}

void MappedFile::release(const char* begin, const char* end) const {
  if (begin >= end) return;
  const auto offset = [this](const char* at) { return static_cast<std::size_t>(at - data_); };
  const std::size_t page = static_cast<std::size_t>(::sysconf(_SC_PAGESIZE));
  const std::size_t from = (offset(begin) - std::min(offset(begin), fault_bytes)) / page * page;
  const std::size_t to = std::min(size_, offset(end) + fault_bytes);
  ::madvise(const_cast<char*>(data_ + from), to - from, MADV_DONTNEED);
}

Result<void> MappedFile::read(std::uint64_t offset, std::span<char> into) const {
  while (!into.empty()) {
    const ssize_t n = ::pread(descriptor_, into.data(), into.size(), static_cast<off_t>(offset));
    if (n < 0 && errno == EINTR) continue;
    if (n < 0) return os_error(path_, "cannot read");
    if (n == 0) return fail(ErrorCode::io, path_.string(), "", "the file became shorter while it was read");
    offset += static_cast<std::uint64_t>(n);
    into = into.subspan(static_cast<std::size_t>(n));
  }
  return {};
}

void MappedFile::close_descriptor() {
  if (descriptor_ >= 0) ::close(std::exchange(descriptor_, -1));
}

Result<void> MappedFile::check_unchanged() const {
  const bool faulted = guard_.has_faulted();
  if (!is_named_ && !faulted) return {};
  Stamp now = stamp_;
  struct stat info {};
  const bool is_found =
      descriptor_ >= 0 ? ::fstat(descriptor_, &info) == 0 : ::stat(path_.c_str(), &info) == 0;
  if (is_found) now = stamp_of(info);
  if (now.device != stamp_.device || now.node != stamp_.node) now = stamp_;  // the map still has the other
  if (now.size < stamp_.size)
    return fail(ErrorCode::io, path_.string(), "",
                "the file became shorter while it was read; read it again when nothing writes to it");
  if (faulted)
    return fail(ErrorCode::io, path_.string(), "",
                "a part of the file could not be read: its disk fails, or the file was shorter for a time");
  if (now == stamp_) return {};
  return fail(ErrorCode::io, path_.string(), "",
              "the file changed while it was read; read it again when nothing writes to it");
}

}  // namespace cuesta
