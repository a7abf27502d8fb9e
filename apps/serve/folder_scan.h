#pragma once
/// Which files there are under a path. Symbolic links below it are not followed, and names that begin with a
/// dot are not looked at, so what is found lies under the path.

#include <filesystem>
#include <functional>
#include <string>

#include "apps/serve/served_file.h"
#include "ooc/result.h"

namespace cuesta::serve {

/// Depth of folders that are looked into, and files that are found; what is beyond is left out.
inline constexpr int deepest_folder = 16;
inline constexpr std::size_t most_files = 100'000;

/// A file that was found. `open` gives nothing if it is no longer what it was.
struct FoundFile {
  std::string name;  ///< below the path, parts separated by '/'; the file's own name where the path is a file
  FileStamp stamp;
  int folder;             ///< an open folder
  std::string in_folder;  ///< its name there

  Descriptor open() const;
};

/// Calls `found` with every regular file whose name ends in `suffix`, in the order of names.
/// @param path  a file or a folder; may itself be a link.
/// @error not_found, io: of `path` itself. Folders below that cannot be read are left out.
Result<void> scan_files(const std::filesystem::path& path, std::string_view suffix,
                        const std::function<void(const FoundFile&)>& found);

}  // namespace cuesta::serve
