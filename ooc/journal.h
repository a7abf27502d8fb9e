#pragma once
/// What a long build has finished, kept so that the next run goes on from there: an SQLite database in the
/// build's work folder. A task is a pure function with an address, (stage, number); its result is a few bytes
/// that say where its output lies.

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "ooc/result.h"

struct sqlite3;

namespace cuesta {

/// One thread at a time. What was recorded survives the end of the process at any moment. Not a power
/// failure: the data that records speak of are not synced, so put what changes at a restart (the boot's id)
/// into the fingerprint.
class Journal {
 public:
  /// Opens or makes the journal; one of another `fingerprint` or of another version is emptied.
  /// @param fingerprint  of the inputs and options: what the tasks are functions of
  /// @error io, also when another process has it open; out_of_budget (disk full, or a limit); corrupt when
  /// the
  ///        file is damaged or something else.
  static Result<Journal> open(const std::filesystem::path& path, const std::string& fingerprint,
                              bool resume = true);
  Journal(Journal&&) noexcept = default;
  Journal& operator=(Journal&&) noexcept = default;

  /// True if it was there already, with something finished in it.
  bool is_resumed() const { return resumed_; }
  /// The result of a finished task. @error corrupt when its checksum differs, or the database is damaged.
  Result<std::optional<std::vector<std::byte>>> find(std::string_view stage, std::uint64_t number) const;
  /// How many tasks of the stage are finished. Tasks that are recorded in order are then 0 … count - 1.
  Result<std::uint64_t> count(std::string_view stage) const;
  /// Nothing can be recorded any more.
  void close() { db_.reset(); }
  Result<void> record(std::string_view stage, std::uint64_t number, std::span<const std::byte> result);

 private:
  struct Close {
    void operator()(sqlite3* db) const;
  };
  Journal() = default;
  Result<void> execute(const char* sql) const;
  tl::unexpected<Error> error(const char* what) const;

  std::filesystem::path path_;
  std::unique_ptr<sqlite3, Close> db_;
  bool resumed_ = false;
};

/// What a journal says is not what was recorded. @param place  stage and number; may be empty
tl::unexpected<Error> damaged_journal(std::string place = {}, const std::filesystem::path& file = {});

}  // namespace cuesta
