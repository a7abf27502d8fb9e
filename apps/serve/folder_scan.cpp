#include "apps/serve/folder_scan.h"

#include <dirent.h>
#include <fcntl.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <memory>
#include <vector>

namespace cuesta::serve {
namespace {

/// Headers, pages and messages hold names: those with control characters, or with bytes that are no text of a
/// path, are not served.
bool is_servable(std::string_view name) {
  return !name.empty() && name.front() != '.' && std::none_of(name.begin(), name.end(), [](char c) {
    return static_cast<unsigned char>(c) < 0x20 || c == 0x7F || c == '\\';
  });
}

std::vector<std::string> names_in(int folder) {
  std::vector<std::string> names;
  const int copy = ::openat(folder, ".", O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  if (copy < 0) return names;
  const std::unique_ptr<DIR, int (*)(DIR*)> stream(::fdopendir(copy), ::closedir);
  if (!stream) return ::close(copy), names;
  while (const dirent* entry = ::readdir(stream.get()))
    if (is_servable(entry->d_name)) names.emplace_back(entry->d_name);
  std::sort(names.begin(), names.end());
  return names;
}

class Scan {
 public:
  Scan(std::string_view suffix, const std::function<void(const FoundFile&)>& found)
      : suffix_(suffix), found_(found) {}

  void folder(int descriptor, const std::string& prefix, int depth) {
    for (const std::string& name : names_in(descriptor)) {
      struct stat status {};
      if (count_ >= most_files || ::fstatat(descriptor, name.c_str(), &status, AT_SYMLINK_NOFOLLOW) != 0)
        continue;
      if (S_ISDIR(status.st_mode) && depth < deepest_folder) {
        const Descriptor below(
            ::openat(descriptor, name.c_str(), O_RDONLY | O_DIRECTORY | O_NOFOLLOW | O_CLOEXEC));
        if (below.is_open()) folder(below.get(), prefix + name + '/', depth + 1);
      } else if (S_ISREG(status.st_mode) && name.ends_with(suffix_)) {
        ++count_;
        found_({prefix + name, FileStamp::of(status), descriptor, name});
      }
    }
  }

 private:
  std::string_view suffix_;
  const std::function<void(const FoundFile&)>& found_;
  std::size_t count_ = 0;
};

tl::unexpected<Error> path_error(const std::filesystem::path& path) {
  return fail(errno == ENOENT || errno == ENOTDIR ? ErrorCode::not_found : ErrorCode::io, path.string(), "",
              std::strerror(errno));
}

}  // namespace

Descriptor FoundFile::open() const {
  Descriptor file(::openat(folder, in_folder.c_str(), O_RDONLY | O_NOFOLLOW | O_NONBLOCK | O_CLOEXEC));
  struct stat status {};
  if (!file.is_open() || ::fstat(file.get(), &status) != 0 || !S_ISREG(status.st_mode) ||
      FileStamp::of(status) != stamp)
    return Descriptor();
  return file;
}

Result<void> scan_files(const std::filesystem::path& path, std::string_view suffix,
                        const std::function<void(const FoundFile&)>& found) {
  // The path is its user's word: links in it are followed.
  std::error_code error;
  const auto real = std::filesystem::canonical(path, error);
  if (error) return errno = error.value(), path_error(path);
  const Descriptor folder(::open(real.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC));
  if (folder.is_open()) {
    Scan(suffix, found).folder(folder.get(), "", 0);
    return {};
  }
  if (errno != ENOTDIR) return path_error(path);
  const Descriptor parent(::open(real.parent_path().c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC));
  struct stat status {};
  if (!parent.is_open() ||
      ::fstatat(parent.get(), real.filename().c_str(), &status, AT_SYMLINK_NOFOLLOW) != 0)
    return path_error(path);
  if (!S_ISREG(status.st_mode))
    return fail(ErrorCode::invalid_input, path.string(), "", "neither a folder nor a regular file");
  found({path.filename().string(), FileStamp::of(status), parent.get(), real.filename().string()});
  return {};
}

}  // namespace cuesta::serve
