#pragma once
/// The folder in which a build keeps what would not fit in memory, and what the next run goes on from.

#include <filesystem>
#include <string>

#include "ooc/journal.h"
#include "ooc/result.h"

namespace cuesta {

/// Stays on disk unless remove() is called. One process at a time.
class WorkFolder {
 public:
  /// Makes the folder, or opens the one that an interrupted build of the same `fingerprint` left. A folder
  /// that is anything else is emptied, whatever is in it.
  /// @param resume  false: start over; the folder is removed first, also if another process uses it
  /// @error not_found (its parent), io (also: another process has it), out_of_budget
  static Result<WorkFolder> open(const std::filesystem::path& path, const std::string& fingerprint,
                                 bool resume = true);

  const std::filesystem::path& path() const { return path_; }
  Journal& journal() { return journal_; }
  /// @error out_of_budget when the file system does not have `bytes` and a little free
  Result<void> check_room(std::uint64_t bytes, const char* what) const;
  /// Closes the journal and removes the folder with all that is in it.
  void remove();

 private:
  WorkFolder(std::filesystem::path path, Journal journal)
      : path_(std::move(path)), journal_(std::move(journal)) {}
  std::filesystem::path path_;
  Journal journal_;
};

}  // namespace cuesta
