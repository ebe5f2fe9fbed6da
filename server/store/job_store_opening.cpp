// SPDX-License-Identifier: Apache-2.0
// Opens a job store, or refuses to.
#include <fmt/format.h>

#include <string>
#include <system_error>
#include <utility>
#include <vector>

#include "server/store/job_store_impl.hpp"
#include "server/store/log_damage.hpp"
#include "server/store/schema.hpp"

namespace tessera::store {

using core::ErrorCode;

namespace {

constexpr auto kPageSize = "PRAGMA page_size = 16384";  // of new files
constexpr auto kPragmas = R"(
  PRAGMA journal_mode = WAL;
  PRAGMA synchronous = FULL;
  PRAGMA foreign_keys = OFF;  -- deleting a job leaves its tiles, which are removed a few at a time
  PRAGMA temp_store = MEMORY;  -- else what a statement would need to undo is written to a file, as much again
)";

constexpr auto kInsertJob =
    "INSERT INTO jobs (id, request_id, spec, revision, state, failure, spp, priority, created_ms, "
    "finished_ms,"
    " counters, arithmetic, max_workers, row_xxh3)"
    " VALUES (?1, ?2, ?3, ?4, ?5, ?6, ?7, ?8, ?9, ?10, ?11, ?12, ?13, ?14)";
constexpr auto kUpdateJob =
    "UPDATE jobs SET revision = ?2, state = ?3, failure = ?4, spp = ?5, priority = ?6, finished_ms = ?7,"
    " counters = ?8, arithmetic = ?9, max_workers = ?10, row_xxh3 = ?11 WHERE id = ?1 AND revision < ?2";
// Reads what earlier releases lack, the limit of workers and the checksum, from the end of the row.
constexpr auto kReadJobs =
    "SELECT id, request_id, spec, revision, state, failure, spp, priority, created_ms, finished_ms,"
    " counters, arithmetic, ";
constexpr auto kByAge = " FROM jobs ORDER BY created_ms, rowid";
constexpr auto kByRowid = " FROM jobs WHERE rowid = ?1";
// A lease id has room for epochs up to this.
constexpr std::int64_t kLastEpoch = (1 << 24) - 1;
// Updates the row in place: replacing it would move it, and change twice as many pages.
constexpr auto kWriteTile =
    "INSERT INTO tiles (job_id, tile, done, content, row_xxh3)"
    " SELECT ?1, ?2, ?3, ?4, ?5 WHERE EXISTS (SELECT 1 FROM jobs WHERE id = ?1)"
    " ON CONFLICT (job_id, tile) DO UPDATE"
    " SET done = excluded.done, content = excluded.content, row_xxh3 = excluded.row_xxh3";
constexpr auto kDeleteJob = "DELETE FROM jobs WHERE id = ?1";
constexpr auto kDeletedJobs =
    "SELECT DISTINCT job_id FROM tiles WHERE NOT EXISTS (SELECT 1 FROM jobs WHERE id = job_id)";
// Whether a deleted job still has tiles.
constexpr auto kHasTiles =
    "SELECT 1 FROM tiles WHERE job_id = ?1 AND NOT EXISTS (SELECT 1 FROM jobs WHERE id = ?1) LIMIT 1";
constexpr auto kDeleteTiles =
    "DELETE FROM tiles WHERE rowid IN (SELECT rowid FROM tiles WHERE job_id = ?1"
    " AND NOT EXISTS (SELECT 1 FROM jobs WHERE id = ?1) LIMIT ?2)";
constexpr auto kTilesDone = "SELECT tile, done FROM tiles WHERE job_id = ?1 ORDER BY tile";
constexpr auto kReadTile = "SELECT done, content, row_xxh3 FROM tiles WHERE job_id = ?1 AND tile = ?2";

core::Error damaged(const std::filesystem::path& file, const std::string& how) {
  const std::string folder = file.parent_path().string();
  return {
      ErrorCode::kDataLoss,
      fmt::format("{} is damaged ({}): put back a copy of the state folder; or see with 'tessera-coordinator "
                  "--check {}' which jobs are whole, and keep these with 'tessera-coordinator --salvage {}'",
                  file.string(), how, folder, folder)};
}

// The incomplete transaction at the end of the log, if there is one. Fails if the log is damaged.
core::Result<std::optional<std::string>> expect_whole_log(const std::filesystem::path& file) {
  auto log = look_at_log(log_of(file));
  if (!log) return core::fail(log.error());
  if (log->damage) return core::fail(damaged(file, *log->damage));
  return std::move(log->torn_end);
}

core::Status expect_whole(Database& database, const std::filesystem::path& file) {
  const auto damage = database.structural_damage();
  if (!damage) return core::fail(damage.error());
  if (!damage->empty()) return core::fail(damaged(file, damage->front()));
  return {};
}

// SQLite seeds its random numbers from the system.
constexpr auto kMakeSecret =
    "INSERT OR IGNORE INTO meta VALUES ('secret_0', random()), ('secret_1', random())";

// Zeros if there is none yet.
core::Result<std::array<std::uint64_t, 2>> read_secret(Database& database) {
  const auto first = database.read_number("SELECT value FROM meta WHERE name = 'secret_0'");
  if (!first) return core::fail(first.error());
  const auto second = database.read_number("SELECT value FROM meta WHERE name = 'secret_1'");
  if (!second) return core::fail(second.error());
  return std::array{as_unsigned(*first), as_unsigned(*second)};
}

// Without SQLite, which would create a missing file, and truncate the log of an empty one.
bool is_missing_or_empty(const std::filesystem::path& file) {
  std::error_code error;
  const auto size = std::filesystem::file_size(file, error);
  return error ? error == std::errc::no_such_file_or_directory : size == 0;
}

core::Status expect_database_of_log(const std::filesystem::path& file, bool may_be_new) {
  if (!is_missing_or_empty(file) || (may_be_new && is_missing_or_empty(log_of(file)))) return {};
  return core::fail(lost(file));
}

core::Result<std::uint32_t> read_epoch(Database& database, const std::filesystem::path& file) {
  const auto epoch = database.read_number("SELECT value FROM meta WHERE name = 'epoch'");
  if (!epoch) return core::fail(epoch.error());
  if (*epoch < 1 || *epoch > kLastEpoch)
    return core::fail(damaged(file, "it has lost the count of its starts"));
  return static_cast<std::uint32_t>(*epoch);
}

}  // namespace

core::Status JobStore::Impl::prepare(const std::vector<Wanted>& wanted) {
  for (const auto& [statement, sql] : wanted) {
    auto prepared = database.prepare(sql);
    if (!prepared) return core::fail(prepared.error());
    *statement = std::move(*prepared);
  }
  return {};
}

core::Status JobStore::Impl::prepare_reading(int version) {
  const std::string jobs =
      fmt::format("{}{}, {}", kReadJobs, version < kVersionOfWorkerLimits ? "0" : "max_workers",
                  version < kVersionOfJobSums ? "NULL" : "row_xxh3");
  return prepare({{&list_jobs, jobs + kByAge},
                  {&read_job, jobs + kByRowid},
                  {&tiles_done, kTilesDone},
                  {&read_tile, kReadTile}});
}

core::Status JobStore::Impl::prepare_writing() {
  return prepare({{&insert_job, kInsertJob},
                  {&update_job, kUpdateJob},
                  {&delete_job, kDeleteJob},
                  {&has_tiles, kHasTiles},
                  {&delete_tiles, kDeleteTiles},
                  {&write_tile, kWriteTile}});
}

core::Status JobStore::Impl::find_deleted_jobs() {
  auto list = database.prepare(kDeletedJobs);
  if (!list) return core::fail(list.error());
  return for_each_row(*list, [&] { deleted_jobs.emplace_back(list->bytes(0)); });
}

core::Result<JobStore> JobStore::open(const std::filesystem::path& file, bool may_be_new) {
  if (auto there = expect_database_of_log(file, may_be_new); !there) return core::fail(there.error());
  auto torn_end = expect_whole_log(file);
  if (!torn_end) return core::fail(torn_end.error());
  auto database = Database::open(file);
  if (!database) return core::fail(database.error());
  if (auto set = database->execute(kPageSize); !set) return core::fail(set.error());
  if (auto usable = expect_usable(*database, file, may_be_new); !usable) return core::fail(usable.error());
  if (auto whole = expect_whole(*database, file); !whole) return core::fail(whole.error());
  database->checkpoint_wal_on_close();
  if (auto set = database->execute(kPragmas); !set) return core::fail(set.error());
  if (auto current = bring_up_to_date(*database); !current) return core::fail(current.error());
  if (auto counted = database->execute("UPDATE meta SET value = value + 1 WHERE name = 'epoch'"); !counted) {
    return core::fail(counted.error());
  }
  if (auto made = database->execute(kMakeSecret); !made) return core::fail(made.error());
  database->checkpoint_wal();
  auto impl = std::make_unique<Impl>(std::move(*database), file);
  impl->torn_end = *std::move(torn_end);
  const auto epoch = read_epoch(impl->database, file);
  if (!epoch) return core::fail(epoch.error());
  impl->epoch = *epoch;
  const auto secret = read_secret(impl->database);
  if (!secret) return core::fail(secret.error());
  impl->secret = *secret;
  if (auto prepared = impl->prepare_reading(schema_version()); !prepared) return core::fail(prepared.error());
  if (auto prepared = impl->prepare_writing(); !prepared) return core::fail(prepared.error());
  if (auto found = impl->find_deleted_jobs(); !found) return core::fail(found.error());
  return JobStore(std::move(impl));
}

core::Result<JobStore> JobStore::open_read_only(const std::filesystem::path& file) {
  if (is_missing_or_empty(file)) return core::fail(lost(file));
  auto database = Database::open_read_only(file);
  if (!database) return core::fail(database.error());
  const auto version = expect_readable(*database, file);
  if (!version) return core::fail(version.error());
  auto impl = std::make_unique<Impl>(std::move(*database), file);
  impl->epoch = read_epoch(impl->database, file).value_or(0);
  impl->secret = read_secret(impl->database).value_or(impl->secret);
  if (auto prepared = impl->prepare_reading(*version); !prepared) return core::fail(prepared.error());
  return JobStore(std::move(impl));
}

}  // namespace tessera::store
