#include "ooc/byte_source.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>

namespace cuesta {
namespace {

class LocalFile final : public ByteSource {
 public:
  LocalFile(const std::filesystem::path& path, std::uint64_t size, int descriptor)
      : ByteSource(path, size), descriptor_(descriptor) {}
  ~LocalFile() override { ::close(descriptor_); }

  Result<void> read_at(std::uint64_t offset, std::span<std::byte> bytes) const override {
    for (std::size_t done = 0; done < bytes.size();) {
      const std::uint64_t at = offset + done;
      const ssize_t n =
          ::pread(descriptor_, bytes.data() + done, bytes.size() - done, static_cast<off_t>(at));
      if (n < 0 && errno == EINTR) continue;
      if (n < 0) return fail(ErrorCode::io, path().string(), at_byte(at), std::strerror(errno));
      if (n == 0)
        return fail(ErrorCode::corrupt, path().string(), at_byte(at), "the file was cut off while open");
      done += static_cast<std::size_t>(n);
    }
    return {};
  }

 private:
  int descriptor_;
};

}  // namespace

std::string at_byte(std::uint64_t offset) {
  return "byte " + std::to_string(offset);
}

Result<std::unique_ptr<ByteSource>> open_local_file(const std::filesystem::path& path) {
  const int descriptor =
      ::open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK);  // a pipe is refused, not waited for
  if (descriptor < 0)
    return fail(errno == ENOENT ? ErrorCode::not_found : ErrorCode::io, path.string(), "",
                std::strerror(errno));
  struct stat status {};
  const bool known = ::fstat(descriptor, &status) == 0;
  auto file =
      std::make_unique<LocalFile>(path, known ? static_cast<std::uint64_t>(status.st_size) : 0, descriptor);
  if (!known) return fail(ErrorCode::io, path.string(), "", std::strerror(errno));
  if (!S_ISREG(status.st_mode))
    return fail(ErrorCode::invalid_input, path.string(), "", "not a regular file");
  return file;
}

}  // namespace cuesta
