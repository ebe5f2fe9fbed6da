#include "server/store/sqlite.hpp"

#include <fmt/format.h>

#include <utility>

namespace tessera::store {

using core::ErrorCode;

namespace {

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
      return error(ErrorCode::kPermissionDenied,
                   "cannot be opened: let this user read and write the file and its folder");
    case SQLITE_CORRUPT:
    case SQLITE_NOTADB:
      return error(
          ErrorCode::kDataLoss,
          "is damaged: put back a copy of the state folder, or move it away to start without its jobs");
    case SQLITE_BUSY:
      return error(ErrorCode::kUnavailable, "is held by another program: end it");
    default:
      return error(ErrorCode::kInternal,
                   fmt::format("{} ({})", sqlite3_errmsg(database), sqlite3_extended_errcode(database)));
  }
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
  return database;
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
