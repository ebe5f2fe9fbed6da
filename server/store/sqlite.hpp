// SPDX-License-Identifier: Apache-2.0
// A small RAII wrapper of SQLite for the job store, with errors that name the file. Not thread-safe: a
// Database and its Statements belong to one thread at a time.
#pragma once

#include <sqlite3.h>

#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "core/base/error.hpp"

namespace tessera::store {

// A prepared statement. Bind (from 1), step until false, read columns (from 0), reset, and repeat.
class Statement {
 public:
  // An empty statement: every step fails.
  Statement() = default;

  Statement& bind(int index, std::int64_t value);
  // Text and bytes must stay unchanged until reset().
  Statement& bind_text(int index, std::string_view text);
  Statement& bind_blob(int index, std::string_view bytes);
  Statement& bind_null(int index);

  // True if there is a row, false at the end.
  core::Result<bool> step();
  // Runs a statement without rows, and resets it.
  core::Status run();
  void reset();

  std::int64_t integer(int column) const;
  bool is_null(int column) const;
  // A text or blob column; valid until the next step or reset.
  std::string_view bytes(int column) const;

 private:
  friend class Database;
  struct Finalize {
    void operator()(sqlite3_stmt* statement) const { sqlite3_finalize(statement); }
  };
  Statement(sqlite3_stmt* statement, std::filesystem::path file)
      : statement_(statement), file_(std::move(file)) {}

  std::unique_ptr<sqlite3_stmt, Finalize> statement_;
  std::filesystem::path file_;  // for error messages
};

class Database {
 public:
  // Creates the file if it is missing. Closing it leaves file and log unchanged, unless
  // checkpoint_wal_on_close() was called.
  static core::Result<Database> open(const std::filesystem::path& file);
  // Another connection to a file that open() has open, which reads while that one writes.
  static core::Result<Database> open_reader(const std::filesystem::path& file);
  // Sees the same content as open(), including a log that a crash left, but writes nothing, not even beside
  // the file. Only while nobody else has it open.
  static core::Result<Database> open_read_only(const std::filesystem::path& file);

  core::Result<Statement> prepare(std::string_view sql);
  // Runs one or several statements without rows.
  core::Status execute(const std::string& sql);
  // The first column of the first row; 0 if there is none.
  core::Result<std::int64_t> read_number(std::string_view sql);
  // Writes the log into the file, as far as other connections allow: what is only in the log is lost with the
  // log.
  void checkpoint_wal();
  // Writes the whole log into the file and truncates the log. UNAVAILABLE if another connection prevents it.
  core::Status truncate_wal();
  // For a file that is known to be intact: damage could grow.
  void checkpoint_wal_on_close();
  // Writes the content, as it is at one moment, to a file that does not exist yet. Others read and write
  // meanwhile; the log grows until it is done.
  core::Status copy_to(const std::filesystem::path& file);
  // The damage that SQLite finds in the file's structure: one sentence each, the first few; empty if there is
  // none. Reads the whole file, about a gigabyte in a second. Does not check the content of rows.
  core::Result<std::vector<std::string>> structural_damage();
  // The same of one table and its indexes.
  core::Result<std::vector<std::string>> structural_damage_of(std::string_view table);
  // Makes the statement that runs on another thread fail with CANCELLED.
  void interrupt();
  // Whether a transaction is open. An error can end it, such as a full disk.
  bool is_in_transaction() const;
  // Whether the last statement changed a row.
  bool has_changed() const;

 private:
  struct Close {
    void operator()(sqlite3* database) const { sqlite3_close_v2(database); }
  };
  Database(sqlite3* database, std::filesystem::path file) : database_(database), file_(std::move(file)) {}
  core::Result<std::vector<std::string>> check(const std::string& pragma);

  std::unique_ptr<sqlite3, Close> database_;
  std::filesystem::path file_;
};

// A transaction from begin() to commit(). Rolls back if it is destroyed before commit().
class Transaction {
 public:
  static core::Result<Transaction> begin(Database& database);
  Transaction(Transaction&& other) noexcept : database_(std::exchange(other.database_, nullptr)) {}
  Transaction& operator=(Transaction&&) = delete;
  ~Transaction();

  core::Status commit();

 private:
  explicit Transaction(Database& database) : database_(&database) {}

  Database* database_;  // null after the end
};

}  // namespace tessera::store
