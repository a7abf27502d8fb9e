#include "ooc/temp_file.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/statvfs.h>
#include <unistd.h>

#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <limits>
#include <string>
#include <utility>

#include "ooc/file_handle.h"

namespace cuesta {
namespace {

constexpr std::uint64_t check_interval_bytes = std::uint64_t{16} << 20;

tl::unexpected<Error> os_error(const std::filesystem::path& folder, const char* what) {
  return fail(code_of_errno(errno), folder.string(), "",
              fmt::format("{}: {}; choose another folder with --temp or TMPDIR", what, std::strerror(errno)));
}

/// Not every file system knows O_TMPFILE: there a name is made and removed at once.
int open_unnamed(const std::filesystem::path& folder) {
  const int descriptor = ::open(folder.c_str(), O_TMPFILE | O_RDWR | O_CLOEXEC, 0600);
  if (descriptor >= 0 || (errno != EOPNOTSUPP && errno != EISDIR)) return descriptor;
  std::string name = (folder / "cuesta-XXXXXX").string();
  const int named = ::mkostemp(name.data(), O_CLOEXEC);
  if (named >= 0) ::unlink(name.c_str());
  return named;
}

std::uint64_t room_bytes(int descriptor) {
  struct statvfs info {};
  if (::fstatvfs(descriptor, &info) != 0) return std::numeric_limits<std::uint64_t>::max();
  return std::uint64_t{info.f_bavail} * info.f_frsize;
}

}  // namespace

std::filesystem::path temp_folder(const std::filesystem::path& folder) {
  if (!folder.empty()) return folder;
  const char* chosen = std::getenv("TMPDIR");
  return chosen && *chosen ? chosen : "/tmp";
}

Result<TempFile> TempFile::create(const std::filesystem::path& folder) {
  TempFile file;
  file.folder_ = temp_folder(folder);
  file.descriptor_ = open_unnamed(file.folder_);
  if (file.descriptor_ < 0) return os_error(file.folder_, "cannot make a temporary file");
  return file;
}

TempFile::TempFile(TempFile&& other) noexcept
    : folder_(std::move(other.folder_)),
      descriptor_(std::exchange(other.descriptor_, -1)),
      written_(other.written_),
      checked_(other.checked_) {}

TempFile& TempFile::operator=(TempFile&& other) noexcept {
  std::swap(folder_, other.folder_);
  std::swap(descriptor_, other.descriptor_);
  std::swap(written_, other.written_);
  std::swap(checked_, other.checked_);
  return *this;
}

TempFile::~TempFile() {
  if (descriptor_ >= 0) ::close(descriptor_);
}

Result<void> TempFile::expect(std::uint64_t bytes) const {
  const std::uint64_t room = room_bytes(descriptor_);
  if (room >= spare_bytes && bytes <= room - spare_bytes) return {};
  return fail(
      ErrorCode::out_of_budget, folder_.string(), "",
      fmt::format("{} more bytes of temporary data do not fit: {} are free there, and {} of them stay free; "
                  "choose another folder with --temp or TMPDIR",
                  bytes, room, spare_bytes));
}

Result<void> TempFile::write(std::span<const char> bytes) {
  if (written_ + bytes.size() > checked_) {
    if (auto r = expect(check_interval_bytes + bytes.size()); !r) return r;
    checked_ = written_ + bytes.size() + check_interval_bytes;
  }
  while (!bytes.empty()) {
    const ssize_t n = ::write(descriptor_, bytes.data(), bytes.size());
    if (n < 0 && errno == EINTR) continue;
    if (n < 0) return os_error(folder_, "cannot write a temporary file");
    written_ += static_cast<std::uint64_t>(n);
    bytes = bytes.subspan(static_cast<std::size_t>(n));
  }
  return {};
}

Result<void> TempFile::read(std::uint64_t offset, std::span<char> bytes) const {
  while (!bytes.empty()) {
    const ssize_t n = ::pread(descriptor_, bytes.data(), bytes.size(), static_cast<off_t>(offset));
    if (n < 0 && errno == EINTR) continue;
    if (n < 0) return os_error(folder_, "cannot read a temporary file");
    if (n == 0) return fail(ErrorCode::io, folder_.string(), "", "a temporary file ends too early");
    offset += static_cast<std::uint64_t>(n);
    bytes = bytes.subspan(static_cast<std::size_t>(n));
  }
  return {};
}

Result<MappedFile> TempFile::map() const {
  return MappedFile::map(descriptor_, folder_);
}

}  // namespace cuesta
