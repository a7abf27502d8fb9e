#pragma once
/// A file that is open for as long as anybody sends from it, whatever becomes of its name.

#include <sys/stat.h>
#include <unistd.h>

#include <cstdint>
#include <string>
#include <string_view>
#include <utility>

namespace cuesta::serve {

/// Owns a file descriptor.
class Descriptor {
 public:
  explicit Descriptor(int number = -1) : number_(number) {}
  Descriptor(Descriptor&& other) noexcept : number_(std::exchange(other.number_, -1)) {}
  Descriptor& operator=(Descriptor&& other) noexcept {
    std::swap(number_, other.number_);
    return *this;
  }
  ~Descriptor() {
    if (number_ >= 0) ::close(number_);
  }
  int get() const { return number_; }
  bool is_open() const { return number_ >= 0; }
  int release() { return std::exchange(number_, -1); }
  /// A name by which this process can open the very same file again, also when it has no other name any more.
  std::string path() const { return "/proc/self/fd/" + std::to_string(number_); }

 private:
  int number_;
};

/// Equal for one content of one file: who writes to a file changes its times.
struct FileStamp {
  std::uint64_t device = 0, inode = 0, bytes = 0;
  std::int64_t modified_ns = 0, changed_ns = 0;

  static FileStamp of(const struct stat& status) {
    const auto ns = [](const timespec& t) { return std::int64_t{t.tv_sec} * 1'000'000'000 + t.tv_nsec; };
    return {status.st_dev, status.st_ino, static_cast<std::uint64_t>(status.st_size), ns(status.st_mtim),
            ns(status.st_ctim)};
  }
  friend bool operator==(const FileStamp&, const FileStamp&) = default;
};

struct ServedFile {
  Descriptor descriptor;
  FileStamp stamp;
  std::string etag;  ///< strong, with its quotes
  std::string content_type;
  std::string validator_lines;  ///< of every response: ETag, Last-Modified, Accept-Ranges

  std::uint64_t bytes() const { return stamp.bytes; }
  std::int64_t modified_s() const { return stamp.modified_ns / 1'000'000'000; }
};

/// @param tag  without quotes; nothing that a header may not hold.
ServedFile make_served_file(Descriptor descriptor, const FileStamp& stamp, std::string_view tag,
                            std::string content_type);

}  // namespace cuesta::serve
