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

}  // namespace

Result<AtomicFile> AtomicFile::create(const std::filesystem::path& path) {
  auto part = FileHandle::create(part_of(path));
  if (!part) return fail(part.error());
  return AtomicFile(path, std::move(*part), 0);
}

Result<AtomicFile> AtomicFile::resume(const std::filesystem::path& path, std::uint64_t bytes) {
  auto part = FileHandle::open(part_of(path));
  if (!part) return fail(part.error());
  const auto size = part->size();
  if (!size) return fail(size.error());
  if (*size < bytes)
    return fail(
        ErrorCode::corrupt, part_of(path).string(), "",
        "expected " + std::to_string(bytes) + " bytes of an unfinished file, found " + std::to_string(*size));
  if (auto r = part->resize(bytes); !r) return fail(r.error());
  return AtomicFile(path, std::move(*part), bytes);
}

AtomicFile::~AtomicFile() {
  if (part_.is_open() && !keep_part_) ::unlink(part_of(path_).c_str());
}

Result<void> AtomicFile::write(std::span<const std::byte> bytes) {
  CUESTA_CHECK(part_.is_open());
  if (auto r = part_.write_at(written_, bytes); !r) return r;
  written_ += bytes.size();
  return {};
}

Result<void> AtomicFile::rewrite(std::uint64_t offset, std::span<const std::byte> bytes) {
  CUESTA_CHECK(part_.is_open());
  CUESTA_CHECK(offset + bytes.size() <= written_, offset, bytes.size(), written_);
  return part_.write_at(offset, bytes);
}

Result<void> AtomicFile::commit() {
  CUESTA_CHECK(part_.is_open());
  if (auto r = part_.sync(); !r) return r;
  // The part stays open until the name is there: what fails before that leaves no part behind.
  if (::rename(part_of(path_).c_str(), path_.c_str()) != 0)
    return fail(code_of_errno(errno), path_.string(), "",
                std::string("cannot rename into place: ") + std::strerror(errno));
  part_ = {};
  sync_folder(path_);
  return {};
}

}  // namespace cuesta
