#pragma once
/// An open .cuesta file: its directory, and pages on demand.

#include <filesystem>

#include "hierarchy/directory.h"
#include "ooc/container_file.h"

namespace cuesta {

class CuestaFile {
 public:
  /// Reads and checks header and directory. @error as ContainerReader::open and decode_directory.
  static Result<CuestaFile> open(const std::filesystem::path& path);

  const Directory& directory() const { return directory_; }
  const std::filesystem::path& path() const { return container_.path(); }
  std::uint64_t file_bytes() const { return container_.file_bytes(); }

  /// Reads, checks and decodes one page. Concurrent calls are safe. @pre id < directory().pages.size().
  /// @error io; corrupt (checksum, damaged stream, or a page that contradicts its directory entry), place
  /// "page N".
  Result<Page> read_page(PageId id) const;

 private:
  CuestaFile(ContainerReader container, Directory directory)
      : container_(std::move(container)), directory_(std::move(directory)) {}
  ContainerReader container_;
  Directory directory_;
};

}  // namespace cuesta
