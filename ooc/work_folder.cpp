#include "ooc/work_folder.h"

#include <fmt/format.h>
#include <sys/statvfs.h>

#include <system_error>

#include "ooc/file_handle.h"
#include "ooc/temp_file.h"

namespace cuesta {

Result<WorkFolder> WorkFolder::open(const std::filesystem::path& path, const std::string& fingerprint,
                                    bool resume) {
  const auto journal_path = path / "journal.sqlite";
  std::error_code failed;
  std::filesystem::create_directory(path, failed);
  if (failed)
    return fail(code_of_errno(failed.value()), path.string(), "",
                "cannot make the work folder: " + failed.message() + "; choose another place with --temp");
  if (!std::filesystem::exists(journal_path, failed) && !std::filesystem::is_empty(path, failed))
    return fail(ErrorCode::invalid_input, path.string(), "",
                "is needed for work in progress, and holds something else; move it, or choose another place "
                "with --temp");
  // Who has the journal has the folder: nothing is touched before.
  auto journal = Journal::open(journal_path, fingerprint, resume);
  if (!journal && !resume && journal.error().code == ErrorCode::corrupt) {
    std::filesystem::remove(journal_path, failed);
    std::filesystem::remove(journal_path.string() + "-wal", failed);
    journal = Journal::open(journal_path, fingerprint, resume);
  }
  if (!journal) return fail(journal.error());
  if (!journal->is_resumed())
    for (const auto& entry : std::filesystem::directory_iterator(path, failed))
      if (!entry.path().filename().string().starts_with("journal."))
        std::filesystem::remove_all(entry.path(), failed);
  return WorkFolder(path, std::move(*journal));
}

Result<void> WorkFolder::check_room(std::uint64_t bytes, const char* what) const {
  struct statvfs info {};
  if (::statvfs(path_.c_str(), &info) != 0) return {};
  const std::uint64_t room = std::uint64_t{info.f_bavail} * info.f_frsize;
  if (bytes + TempFile::spare_bytes <= room) return {};
  return fail(ErrorCode::out_of_budget, path_.string(), "",
              fmt::format("{} needs about {} MiB of disk, {} MiB are free there; choose another place with "
                          "--temp",
                          what, bytes >> 20, room >> 20));
}

void WorkFolder::remove() {
  journal_.close();
  std::error_code ignored;
  std::filesystem::remove_all(path_, ignored);
}

}  // namespace cuesta
