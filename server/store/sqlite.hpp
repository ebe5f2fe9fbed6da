// SPDX-License-Identifier: Apache-2.0
// The little of SQLite that the job store uses, as values that close themselves and answers that name the
// file. Not thread-safe: a Database and its Statements belong to one thread at a time.
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

// One prepared statement. Bind (from 1), step until false, read columns (from 0), reset, and again.
class Statement {
 public:
  // Holds none: every step fails.
  Statement() = default;

  Statement& bind(int index, std::int64_t value);
  // Text and bytes must stay as they are until reset().
  Statement& bind_text(int index, std::string_view text);
  Statement& bind_blob(int index, std::string_view bytes);
  Statement& bind_null(int index);

  // True if there is a row to be read, false at the end.
  core::Result<bool> step();
  // Runs a statement without rows, and resets it.
  core::Status run();
  void reset();

  std::int64_t integer(int column) const;
  bool is_null(int column) const;
  // Of a text or a blob; valid until the next step or reset.
  std::string_view bytes(int column) const;

 private:
  friend class Database;
  struct Finalize {
    void operator()(sqlite3_stmt* statement) const { sqlite3_finalize(statement); }
  };
  Statement(sqlite3_stmt* statement, std::filesystem::path file)
      : statement_(statement), file_(std::move(file)) {}

  std::unique_ptr<sqlite3_stmt, Finalize> statement_;
  std::filesystem::path file_;  // for errors
};

class Database {
 public:
  // Creates the file if it is missing. Closing it leaves file and log as they are, unless
  // checkpoint_wal_on_close() was called.
  static core::Result<Database> open(const std::filesystem::path& file);
  // Sees what open() would see, a crash's leftovers included, and writes nothing at all, not even beside the
  // file. Only while nobody else has it open.
  static core::Result<Database> open_read_only(const std::filesystem::path& file);

  core::Result<Statement> prepare(std::string_view sql);
  // One or several statements without rows.
  core::Status execute(const std::string& sql);
  // The first column of the first row; 0 if there is none.
  core::Result<std::int64_t> read_number(std::string_view sql);
  // Writes the log's content into the file itself, as far as nobody is in the way: what is in the log alone
  // goes with the log.
  void checkpoint_wal();
  // The same, to the last byte, and empties the log. UNAVAILABLE if somebody is in the way.
  core::Status truncate_wal();
  // For a file that is known to be whole: one that is damaged would be damaged further.
  void checkpoint_wal_on_close();
  // What SQLite finds wrong with the file's structure: a sentence for each, the first few; empty if it is
  // whole. Reads all of it, about a gigabyte in a second. What stands in the rows is not looked at.
  core::Result<std::vector<std::string>> structural_damage();

 private:
  struct Close {
    void operator()(sqlite3* database) const { sqlite3_close_v2(database); }
  };
  Database(sqlite3* database, std::filesystem::path file) : database_(database), file_(std::move(file)) {}

  std::unique_ptr<sqlite3, Close> database_;
  std::filesystem::path file_;
};

// Everything between begin() and commit() happens, or nothing of it. Rolls back if destroyed before.
class Transaction {
 public:
  static core::Result<Transaction> begin(Database& database);
  Transaction(Transaction&& other) noexcept : database_(std::exchange(other.database_, nullptr)) {}
  Transaction& operator=(Transaction&&) = delete;
  ~Transaction();

  core::Status commit();

 private:
  explicit Transaction(Database& database) : database_(&database) {}

  Database* database_;  // null once it is over
};

}  // namespace tessera::store
