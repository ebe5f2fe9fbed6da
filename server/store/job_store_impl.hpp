// SPDX-License-Identifier: Apache-2.0
// What the sources of the job store share: the connections, their statements, and the reading of a job's row.
// Private to the store.
#pragma once

#include <array>
#include <atomic>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "core/base/mutex.hpp"
#include "server/store/group_commit.hpp"
#include "server/store/job_store.hpp"
#include "server/store/sqlite.hpp"

namespace tessera::store {

using Wanted = std::vector<std::pair<Statement*, std::string>>;
core::Status prepare(Database& database, const Wanted& wanted);

// The connection that writes. Used by one group of changes at a time.
struct Writer {
  explicit Writer(Database opened) : database(std::move(opened)) {}
  core::Status prepare_all();
  // Runs an update of a job's row whose values are bound. Returns whether there was a row to update.
  core::Result<bool> run_update(Statement& update, const JobRow& job);

  Database database;
  Statement insert_job, update_job, end_validation, replace_job, settle_job, set_indexed, delete_job,
      note_deleted, forget_deleted, write_tile, write_revision, has_tiles, delete_tiles;
};

// The connection that reads.
struct Reader {
  explicit Reader(Database opened) : database(std::move(opened)) {}
  // For a file of this version of the schema. Lists in pages need indexes, which a damaged file may lack.
  core::Status prepare_all(int version, bool with_lists);

  Database database;
  Statement list_jobs, unsettled_jobs, job, job_of_request, next_job, read_job, page, page_of_prefix,
      settled_count, first_settled, tiles_done, tile_changes, read_tile;
};

struct JobStore::Impl {
  // `writer`: absent if the file is open for reading only.
  Impl(std::filesystem::path path, std::optional<Writer> writing, Reader reads)
      : file(std::move(path)),
        writer(std::move(writing)),
        reader(std::move(reads)),
        commits([this](std::span<PendingChange* const> group) { apply(group); }) {}

  // Writes a change in a transaction, which others may share.
  core::Status write(const std::function<core::Status()>& change);
  void apply(std::span<PendingChange* const> group);
  // Finds deleted jobs whose tiles were not all removed before the coordinator ended.
  core::Status find_deleted_jobs() TESSERA_REQUIRES(reading);
  core::Status remove_tiles_of(const std::string& job);
  core::Status give_back_free_pages();

  const std::filesystem::path file;
  std::optional<Writer> writer;
  core::Mutex reading;
  Reader reader TESSERA_GUARDED_BY(reading);
  GroupCommit commits;
  std::uint32_t epoch = 0;
  std::array<std::uint64_t, 2> secret{};
  std::optional<std::string> torn_end;
  bool has_rest_to_check = false;
  std::atomic<bool> wants_checkpoint{false};  // of the log, after the next group

  core::Mutex mutex;
  std::vector<std::string> deleted_jobs TESSERA_GUARDED_BY(mutex);  // that may have tiles
  std::optional<core::Error> damage TESSERA_GUARDED_BY(mutex);      // found by check_rest()
};

inline std::int64_t as_signed(std::uint64_t value) {
  return static_cast<std::int64_t>(value);
}
inline std::uint64_t as_unsigned(std::int64_t value) {
  return static_cast<std::uint64_t>(value);
}

// Reads a job from the current row of a statement.
JobRow read_job(const Statement& row);
// The error for a damaged file.
core::Error damaged(const std::filesystem::path& file, const std::string& how);

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
