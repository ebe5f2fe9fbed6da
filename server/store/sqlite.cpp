// SPDX-License-Identifier: Apache-2.0
#include "server/store/sqlite.hpp"

#include <fmt/format.h>

#include <cerrno>
#include <cstddef>
#include <filesystem>
#include <system_error>
#include <utility>

#include "server/store/log_damage.hpp"

namespace tessera::store {

using core::ErrorCode;

namespace {

// SQLite's own limit is 512, including the names of its log and journal.
constexpr std::size_t kMaxPathBytes = 500;

core::Error sqlite_error(sqlite3* database, const std::filesystem::path& file) {
  const int code = sqlite3_errcode(database) & 0xff;
  const auto error = [&](ErrorCode kind, std::string_view advice) {
    return core::Error{kind, fmt::format("{}: {}", file.string(), advice)};
  };
  switch (code) {
    case SQLITE_FULL:
      return error(ErrorCode::kResourceExhausted, "the disk is full: free some space there");
    case SQLITE_READONLY:
    case SQLITE_PERM:
      return error(ErrorCode::kPermissionDenied,
                   "cannot be written: let this user write to the file and its folder");
    case SQLITE_CANTOPEN:
      if (std::filesystem::absolute(file).native().size() > kMaxPathBytes)
        return error(ErrorCode::kInvalidArgument,
                     fmt::format("the path has more than {} bytes, which SQLite cannot open: choose a folder "
                                 "with a shorter path with --state",
                                 kMaxPathBytes));
      return error(ErrorCode::kPermissionDenied,
                   "cannot be opened: let this user read and write the file and its folder");
    case SQLITE_CORRUPT:
    case SQLITE_NOTADB:
      return error(
          ErrorCode::kDataLoss,
          "is damaged: put back a copy of the state folder, keep what is whole with --salvage, or move the "
          "folder away to start without its jobs");
    case SQLITE_IOERR:
      if (sqlite3_system_errno(database) == EFBIG)
        return error(ErrorCode::kResourceExhausted, "it is too large: raise the limit (ulimit -f)");
      return error(ErrorCode::kInternal,
                   fmt::format("the disk failed to read or write ({}): check its health and its free space",
                               sqlite3_extended_errcode(database)));
    case SQLITE_INTERRUPT:
      return error(ErrorCode::kCancelled, "is not read any further");
    case SQLITE_BUSY:
      return error(ErrorCode::kUnavailable, "is held by another program: end it");
    default:
      return error(ErrorCode::kInternal,
                   fmt::format("{} ({})", sqlite3_errmsg(database), sqlite3_extended_errcode(database)));
  }
}

// Escapes a path for a URI.
std::string escaped(const std::string& path) {
  std::string result;
  for (const char c : path) {
    if (c == '%' || c == '?' || c == '#')
      result += fmt::format("%{:02x}", static_cast<unsigned>(c));
    else
      result += c;
  }
  return result;
}

// A null pointer would be SQL's NULL, not an empty text.
const char* not_null(std::string_view bytes) {
  return bytes.data() == nullptr ? "" : bytes.data();
}

}  // namespace

Statement& Statement::bind(int index, std::int64_t value) {
  sqlite3_bind_int64(statement_.get(), index, value);
  return *this;
}

Statement& Statement::bind_text(int index, std::string_view text) {
  sqlite3_bind_text64(statement_.get(), index, not_null(text), text.size(), SQLITE_STATIC, SQLITE_UTF8);
  return *this;
}

Statement& Statement::bind_blob(int index, std::string_view bytes) {
  sqlite3_bind_blob64(statement_.get(), index, not_null(bytes), bytes.size(), SQLITE_STATIC);
  return *this;
}

Statement& Statement::bind_null(int index) {
  sqlite3_bind_null(statement_.get(), index);
  return *this;
}

core::Result<bool> Statement::step() {
  if (!statement_)
    return core::fail(ErrorCode::kFailedPrecondition,
                      "the database is only looked at: nothing is written to it");
  const int code = sqlite3_step(statement_.get());
  if (code == SQLITE_ROW) return true;
  if (code == SQLITE_DONE) return false;
  return core::fail(sqlite_error(sqlite3_db_handle(statement_.get()), file_));
}

core::Status Statement::run() {
  const auto stepped = step();
  reset();
  if (!stepped) return core::fail(stepped.error());
  return {};
}

void Statement::reset() {
  if (!statement_) return;
  sqlite3_reset(statement_.get());
  sqlite3_clear_bindings(statement_.get());
}

std::int64_t Statement::integer(int column) const {
  return sqlite3_column_int64(statement_.get(), column);
}

bool Statement::is_null(int column) const {
  return sqlite3_column_type(statement_.get(), column) == SQLITE_NULL;
}

std::string_view Statement::bytes(int column) const {
  const void* data = sqlite3_column_blob(statement_.get(), column);
  const int size = sqlite3_column_bytes(statement_.get(), column);
  return {static_cast<const char*>(data), static_cast<std::size_t>(size)};
}

core::Result<Database> Database::open(const std::filesystem::path& file) {
  sqlite3* handle = nullptr;
  constexpr int kFlags = SQLITE_OPEN_READWRITE | SQLITE_OPEN_CREATE | SQLITE_OPEN_NOMUTEX;
  const int code = sqlite3_open_v2(file.c_str(), &handle, kFlags, nullptr);
  Database database(handle, file);
  if (code != SQLITE_OK) return core::fail(sqlite_error(handle, file));
  sqlite3_db_config(handle, SQLITE_DBCONFIG_NO_CKPT_ON_CLOSE, 1, nullptr);
  return database;
}

core::Result<Database> Database::open_reader(const std::filesystem::path& file) {
  sqlite3* handle = nullptr;
  constexpr int kFlags = SQLITE_OPEN_READONLY | SQLITE_OPEN_NOMUTEX;
  const int code = sqlite3_open_v2(file.c_str(), &handle, kFlags, nullptr);
  Database database(handle, file);
  if (code != SQLITE_OK) return core::fail(sqlite_error(handle, file));
  sqlite3_db_config(handle, SQLITE_DBCONFIG_NO_CKPT_ON_CLOSE, 1, nullptr);
  return database;
}

core::Result<Database> Database::open_read_only(const std::filesystem::path& file) {
  std::error_code missing;
  const bool has_log = std::filesystem::file_size(log_of(file), missing) > 0 && !missing;
  // Without a log, the file is read as immutable. With one, an exclusive connection keeps the log's index in
  // memory instead of in a file.
  const std::string uri = "file:" + escaped(file.string()) + (has_log ? "?vfs=unix-none" : "?immutable=1");
  sqlite3* handle = nullptr;
  const int code = sqlite3_open_v2(uri.c_str(), &handle,
                                   SQLITE_OPEN_READONLY | SQLITE_OPEN_NOMUTEX | SQLITE_OPEN_URI, nullptr);
  Database database(handle, file);
  if (code != SQLITE_OK) return core::fail(sqlite_error(handle, file));
  sqlite3_db_config(handle, SQLITE_DBCONFIG_NO_CKPT_ON_CLOSE, 1, nullptr);
  // writable_schema: a truncated file is read as far as possible.
  if (auto set = database.execute("PRAGMA locking_mode = EXCLUSIVE; PRAGMA writable_schema = ON"); !set)
    return core::fail(set.error());
  return database;
}

void Database::checkpoint_wal() {
  [[maybe_unused]] const auto later = execute("PRAGMA wal_checkpoint");  // on failure, SQLite does it later
}

core::Status Database::truncate_wal() {
  const auto busy = read_number("PRAGMA wal_checkpoint(TRUNCATE)");
  if (!busy) return core::fail(busy.error());
  if (*busy == 0) return {};
  return core::fail(ErrorCode::kUnavailable,
                    fmt::format("{}: is held by another program: end it", file_.string()));
}

void Database::checkpoint_wal_on_close() {
  sqlite3_db_config(database_.get(), SQLITE_DBCONFIG_NO_CKPT_ON_CLOSE, 0, nullptr);
}

core::Status Database::copy_to(const std::filesystem::path& file) {
  auto copy = open(file);
  if (!copy) return core::fail(copy.error());
  constexpr int kAllPages = -1;
  sqlite3_backup* const backup = sqlite3_backup_init(copy->database_.get(), "main", database_.get(), "main");
  if (backup == nullptr) return core::fail(sqlite_error(copy->database_.get(), file));
  sqlite3_backup_step(backup, kAllPages);
  if (sqlite3_backup_finish(backup) == SQLITE_OK) return {};
  return core::fail(sqlite_error(copy->database_.get(), file));
}

core::Result<std::vector<std::string>> Database::structural_damage() {
  return check("PRAGMA integrity_check(5)");
}

core::Result<std::vector<std::string>> Database::structural_damage_of(std::string_view table) {
  return check(fmt::format("PRAGMA integrity_check({})", table));
}

core::Result<std::vector<std::string>> Database::check(const std::string& pragma) {
  auto statement = prepare(pragma);
  if (!statement) return core::fail(statement.error());
  std::vector<std::string> damage;
  auto row = statement->step();
  for (; row && *row; row = statement->step()) damage.emplace_back(statement->bytes(0));
  if (!row) return core::fail(row.error());
  if (damage == std::vector<std::string>{"ok"}) damage.clear();
  return damage;
}

void Database::interrupt() {
  sqlite3_interrupt(database_.get());
}

bool Database::is_in_transaction() const {
  return sqlite3_get_autocommit(database_.get()) == 0;
}

bool Database::has_changed() const {
  return sqlite3_changes(database_.get()) > 0;
}

core::Result<Statement> Database::prepare(std::string_view sql) {
  sqlite3_stmt* statement = nullptr;
  const int size = static_cast<int>(sql.size());
  if (sqlite3_prepare_v3(database_.get(), sql.data(), size, SQLITE_PREPARE_PERSISTENT, &statement, nullptr) !=
      SQLITE_OK) {
    return core::fail(sqlite_error(database_.get(), file_));
  }
  return Statement(statement, file_);
}

core::Status Database::execute(const std::string& sql) {
  if (sqlite3_exec(database_.get(), sql.c_str(), nullptr, nullptr, nullptr) == SQLITE_OK) return {};
  return core::fail(sqlite_error(database_.get(), file_));
}

core::Result<std::int64_t> Database::read_number(std::string_view sql) {
  auto statement = prepare(sql);
  if (!statement) return core::fail(statement.error());
  const auto row = statement->step();
  if (!row) return core::fail(row.error());
  return *row ? statement->integer(0) : 0;
}

core::Result<Transaction> Transaction::begin(Database& database) {
  if (auto begun = database.execute("BEGIN IMMEDIATE"); !begun) return core::fail(begun.error());
  return Transaction(database);
}

Transaction::~Transaction() {
  if (database_ != nullptr) [[maybe_unused]]
    const auto rolled_back = database_->execute("ROLLBACK");
}

core::Status Transaction::commit() {
  auto committed = database_->execute("COMMIT");
  if (committed) database_ = nullptr;
  return committed;
}

}  // namespace tessera::store
