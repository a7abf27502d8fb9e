#include "ooc/journal.h"

#include <sqlite3.h>

#include <cerrno>
#include <cstring>
#include <utility>

#include "ooc/byte_stream.h"
#include "ooc/file_handle.h"
#include "ooc/fingerprint.h"

namespace cuesta {
namespace {

/// Layout of the tables and of what is in them; a journal of another layout is emptied.
constexpr int layout_version = 2;

struct Finalize {
  void operator()(sqlite3_stmt* s) const { sqlite3_finalize(s); }
};
using Statement = std::unique_ptr<sqlite3_stmt, Finalize>;

Statement prepare(sqlite3* db, const char* sql) {
  sqlite3_stmt* s = nullptr;
  sqlite3_prepare_v2(db, sql, -1, &s, nullptr);
  return Statement(s);
}

/// A row as it is stored: a checksum of all that it says, then the result.
std::uint64_t checksum_of(std::string_view stage, std::uint64_t number, std::span<const std::byte> result) {
  ByteWriter w;
  w.put_bytes(std::as_bytes(std::span(stage)));
  w.put(number);
  w.put_bytes(result);
  return checksum(w.bytes());
}

void bind_text(sqlite3_stmt* s, int at, std::string_view text) {
  sqlite3_bind_text(s, at, text.data(), static_cast<int>(text.size()), SQLITE_TRANSIENT);
}

}  // namespace

void Journal::Close::operator()(sqlite3* db) const {
  sqlite3_close(db);
}

tl::unexpected<Error> Journal::error(const char* what) const {
  const int code = db_ ? sqlite3_errcode(db_.get()) : SQLITE_NOMEM;
  const int number = errno;  // sqlite3_system_errno() does not know of failures to commit
  std::string message = std::string(what) + ": " + (db_ ? sqlite3_errmsg(db_.get()) : "no memory");
  const auto failed = [&](ErrorCode is) { return fail(is, path_.string(), "", message); };
  switch (code) {
    case SQLITE_BUSY:
    case SQLITE_LOCKED:
      message = "another process is building this file";
      return failed(ErrorCode::io);
    case SQLITE_NOTADB:
    case SQLITE_CORRUPT:
      message += "; start over with --resume=never";
      return failed(ErrorCode::corrupt);
    case SQLITE_FULL:
      return failed(ErrorCode::out_of_budget);
    default:
      // A quota and a limit on the size of files are I/O errors to SQLite.
      if (number != 0) message += std::string(": ") + std::strerror(number);
      return failed(code == SQLITE_IOERR && number != 0 ? code_of_errno(number) : ErrorCode::io);
  }
}

Result<void> Journal::execute(const char* sql) const {
  errno = 0;
  if (sqlite3_exec(db_.get(), sql, nullptr, nullptr, nullptr) != SQLITE_OK)
    return error("cannot write the journal");
  return {};
}

Result<Journal> Journal::open(const std::filesystem::path& path, const std::string& fingerprint,
                              bool resume) {
  Journal journal;
  journal.path_ = path;
  sqlite3* db = nullptr;
  const int opened = sqlite3_open(path.c_str(), &db);
  journal.db_.reset(db);
  if (opened != SQLITE_OK) return journal.error("cannot open the journal");
  // One process holds it from here to its end.
  for (const char* sql :
       {"PRAGMA locking_mode = EXCLUSIVE", "PRAGMA journal_mode = WAL", "PRAGMA synchronous = NORMAL",
        "BEGIN IMMEDIATE; COMMIT", "CREATE TABLE IF NOT EXISTS build (version INTEGER, fingerprint TEXT)",
        "CREATE TABLE IF NOT EXISTS task (stage TEXT, number INTEGER, result BLOB, "
        "PRIMARY KEY (stage, number)) WITHOUT ROWID"})
    if (auto r = journal.execute(sql); !r) return fail(r.error());
  {
    const Statement same = prepare(db, "SELECT 1 FROM build WHERE version = ? AND fingerprint = ?");
    if (!same) return journal.error("cannot read the journal");
    sqlite3_bind_int(same.get(), 1, layout_version);
    bind_text(same.get(), 2, fingerprint);
    journal.resumed_ = resume && sqlite3_step(same.get()) == SQLITE_ROW;
  }
  if (journal.resumed_) {
    const Statement any = prepare(db, "SELECT 1 FROM task LIMIT 1");
    journal.resumed_ = any && sqlite3_step(any.get()) == SQLITE_ROW;
    return journal;
  }
  if (auto r = journal.execute("DELETE FROM task; DELETE FROM build"); !r) return fail(r.error());
  const Statement insert = prepare(db, "INSERT INTO build VALUES (?, ?)");
  if (!insert) return journal.error("cannot write the journal");
  sqlite3_bind_int(insert.get(), 1, layout_version);
  bind_text(insert.get(), 2, fingerprint);
  if (sqlite3_step(insert.get()) != SQLITE_DONE) return journal.error("cannot write the journal");
  return journal;
}

Result<std::optional<std::vector<std::byte>>> Journal::find(std::string_view stage,
                                                            std::uint64_t number) const {
  const Statement s = prepare(db_.get(), "SELECT result FROM task WHERE stage = ? AND number = ?");
  if (!s) return error("cannot read the journal");
  bind_text(s.get(), 1, stage);
  sqlite3_bind_int64(s.get(), 2, static_cast<sqlite3_int64>(number));
  const int step = sqlite3_step(s.get());
  if (step == SQLITE_DONE) return std::nullopt;
  if (step != SQLITE_ROW) return error("cannot read the journal");
  const auto* data = static_cast<const std::byte*>(sqlite3_column_blob(s.get(), 0));
  const auto size = static_cast<std::size_t>(sqlite3_column_bytes(s.get(), 0));
  ByteReader r(std::span(data, size));
  const auto expected = r.get<std::uint64_t>();
  const auto result = r.get_bytes(r.remaining());
  if (!r.ok() || checksum_of(stage, number, result) != expected)
    return damaged_journal(std::string(stage) + " " + std::to_string(number), path_);
  return std::vector<std::byte>(result.begin(), result.end());
}

Result<std::uint64_t> Journal::count(std::string_view stage) const {
  const Statement s = prepare(db_.get(), "SELECT count(*) FROM task WHERE stage = ?");
  if (!s) return error("cannot read the journal");
  bind_text(s.get(), 1, stage);
  if (sqlite3_step(s.get()) != SQLITE_ROW) return error("cannot read the journal");
  return static_cast<std::uint64_t>(sqlite3_column_int64(s.get(), 0));
}

Result<void> Journal::record(std::string_view stage, std::uint64_t number,
                             std::span<const std::byte> result) {
  const Statement s = prepare(db_.get(), "INSERT OR REPLACE INTO task VALUES (?, ?, ?)");
  if (!s) return error("cannot write the journal");
  ByteWriter row;
  row.put(checksum_of(stage, number, result));
  row.put_bytes(result);
  bind_text(s.get(), 1, stage);
  sqlite3_bind_int64(s.get(), 2, static_cast<sqlite3_int64>(number));
  sqlite3_bind_blob64(s.get(), 3, row.bytes().data(), row.size(), SQLITE_STATIC);
  errno = 0;
  if (sqlite3_step(s.get()) != SQLITE_DONE) return error("cannot write the journal");
  return {};
}

tl::unexpected<Error> damaged_journal(std::string place, const std::filesystem::path& file) {
  return fail(ErrorCode::corrupt, file.string(), std::move(place),
              "the journal of the build is damaged; run the same command again to start over");
}

}  // namespace cuesta
