#pragma once
/// An open .cuesta file: its directory, and pages on demand.

#include <filesystem>
#include <memory>
#include <span>
#include <string>

#include "hierarchy/directory.h"
#include "hierarchy/page_shelf.h"
#include "ooc/container_file.h"

namespace cuesta {

class CuestaFile {
 public:
  /// Reads and checks header and directory. @error as ContainerReader::open and decode_directory.
  static Result<CuestaFile> open(const std::filesystem::path& path);
  /// @param source  shared with whoever delivers its bytes.
  static Result<CuestaFile> open(std::shared_ptr<const ByteSource> source);
  /// A surface among other things in a file: its pages are at their offsets in the container.
  /// @param place  what errors call it, for example "part 3"
  CuestaFile(std::shared_ptr<const ContainerReader> container, Directory directory, std::string place);

  const Directory& directory() const { return directory_; }
  const std::filesystem::path& path() const { return container_->path(); }
  /// Of all that is in the file.
  std::uint64_t file_bytes() const { return container_->file_bytes(); }

  /// Reads, checks and decodes one page. Concurrent calls are safe. @pre id < directory().pages.size().
  /// @param survivors  as Page::survivors: who has the coarser pages knows them (SurvivorPlaces)
  /// @error io; corrupt (checksum, damaged stream, or a page that contradicts its directory entry), place
  /// "page N".
  Result<Page> read_page(PageId id, std::span<const Vec3i> survivors) const;

  /// Pages that are looked for on a shelf first, and put there, when they are taken by shared_page().
  /// @param shelf  of this very file's content.
  void set_shelf(std::shared_ptr<PageShelf> shelf) { shelf_ = std::move(shelf); }
  /// As read_page(); with a shelf, at most one of those who ask decodes it as long as it stays there.
  Result<std::shared_ptr<const Page>> shared_page(PageId id, std::span<const Vec3i> survivors) const;

 private:
  static Result<CuestaFile> open(Result<ContainerReader> container);
  std::shared_ptr<const ContainerReader> container_;  ///< many surfaces may be in one file
  Directory directory_;
  std::string place_;
  std::shared_ptr<PageShelf> shelf_;
};

}  // namespace cuesta
