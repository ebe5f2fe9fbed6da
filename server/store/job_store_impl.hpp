// SPDX-License-Identifier: Apache-2.0
// What the sources of the job store share: the database, its statements, and the reading of a job's row.
// Private to the store.
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <mutex>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "server/store/job_store.hpp"
#include "server/store/sqlite.hpp"

namespace tessera::store {

struct JobStore::Impl {
  Impl(Database opened, std::filesystem::path path) : database(std::move(opened)), file(std::move(path)) {}

  // For a file of this version of the schema.
  core::Status prepare_reading(int version);
  core::Status prepare_writing();
  // Finds deleted jobs whose tiles were not all removed before the coordinator ended.
  core::Status find_deleted_jobs();

  Database database;
  Statement list_jobs, read_job, tiles_done, read_tile;
  // Not prepared if the store is read-only:
  Statement insert_job, update_job, delete_job, write_tile, has_tiles, delete_tiles;
  const std::filesystem::path file;
  std::uint32_t epoch = 0;
  std::array<std::uint64_t, 2> secret{};
  std::optional<std::string> torn_end;
  std::vector<std::string> deleted_jobs;  // that may have tiles
  std::mutex mutex;                       // guards the database, the statements and deleted_jobs

 private:
  using Wanted = std::pair<Statement*, std::string>;
  core::Status prepare(const std::vector<Wanted>& wanted);
};

inline std::int64_t as_signed(std::uint64_t value) {
  return static_cast<std::int64_t>(value);
}
inline std::uint64_t as_unsigned(std::int64_t value) {
  return static_cast<std::uint64_t>(value);
}

// Reads a job from the current row of a statement.
JobRow read_job(const Statement& row);

// Ends a query, also if there is no memory for its rows.
class ResetAtEnd {
 public:
  explicit ResetAtEnd(Statement& statement) : statement_(statement) {}
  ~ResetAtEnd() { statement_.reset(); }
  ResetAtEnd(const ResetAtEnd&) = delete;
  ResetAtEnd& operator=(const ResetAtEnd&) = delete;

 private:
  Statement& statement_;
};

template <typename Take>
core::Status for_each_row(Statement& statement, Take take) {
  const ResetAtEnd at_end(statement);
  auto row = statement.step();
  for (; row && *row; row = statement.step()) take();
  if (!row) return core::fail(row.error());
  return {};
}

}  // namespace tessera::store
