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

// Of new files. An earlier file gets it by VACUUM, which copies the file: only small ones are converted.
constexpr auto kLayout = "PRAGMA page_size = 16384; PRAGMA auto_vacuum = INCREMENTAL";
constexpr auto kConvert = "PRAGMA auto_vacuum = INCREMENTAL; VACUUM";
constexpr std::uint64_t kConvertedAtOpening = std::uint64_t{256} << 20;
constexpr auto kPragmas = R"(
  PRAGMA journal_mode = WAL;
  PRAGMA synchronous = FULL;
  PRAGMA journal_size_limit = 67108864;  -- a log that a long reader has made grow shrinks again
  PRAGMA foreign_keys = OFF;  -- deleting a job leaves its tiles, which are removed a few at a time
  PRAGMA temp_store = MEMORY;  -- else what a statement would need to undo is written to a file, as much again
)";

constexpr auto kInsertJob =
    "INSERT INTO jobs (id, revision, state, failure, spp, priority, finished_ms, counters, arithmetic,"
    " max_workers, row_xxh3, producers, settled, failure_details, targets, spec, submission, owner, bundle,"
    " bundle_xxh3, request_id, created_ms, number)"
    " VALUES (?1, ?2, ?3, ?4, ?5, ?6, ?7, ?8, ?9, ?10, ?11, ?12, ?13, ?14, ?15, ?16, ?17, ?18, ?19, ?20, ?21,"
    " ?22,"
    " (SELECT coalesce(max(number), 0) + 1 FROM jobs))";
constexpr auto kSetColumns =
    "UPDATE jobs SET revision = ?2, failure = ?4, spp = ?5, priority = ?6, counters = ?8, arithmetic = ?9,"
    " max_workers = ?10, row_xxh3 = ?11, producers = ?12, failure_details = ?14, targets = ?15, spec = ?16";
constexpr auto kAndThoseOfValidation = ", submission = ?17, bundle = ?19, bundle_xxh3 = ?20";
constexpr auto kAndTheOthers = ", owner = ?18";
// By themselves, and only if they change, since indexes have them: most changes of a job then write one page.
constexpr auto kSetIndexed =
    "UPDATE jobs SET state = ?2, finished_ms = ?3, settled = ?4"
    " WHERE id = ?1 AND (state IS NOT ?2 OR finished_ms IS NOT ?3 OR settled IS NOT ?4)";
constexpr auto kIfOlder = " WHERE id = ?1 AND revision < ?2";
constexpr auto kIfNotNewer = " WHERE id = ?1 AND revision <= ?2";
constexpr auto kIfEqual = " WHERE id = ?1 AND revision = ?21";
// Reads what earlier releases lack, such as the limit of workers and the checksum, from the end of the row.
constexpr auto kReadJobs =
    "SELECT id, request_id, spec, revision, state, failure, spp, priority, created_ms, finished_ms,"
    " counters, arithmetic";
constexpr auto kByAge = " ORDER BY created_ms, rowid";
// The jobs of a query, by the index that has all columns of its conditions.
constexpr auto kPage =
    "number < ?1 AND created_ms >= ?2 AND created_ms < ?3 AND (?4 IS NULL OR owner = ?4)"
    " AND (?5 = 0 OR settled = 0 OR (?5 >> state) & 1)"
    " ORDER BY number DESC LIMIT ?6";
constexpr auto kOfPrefix = "id >= ?7 AND (id < ?8 OR ?8 = '') AND +";
// A lease id has room for epochs up to this.
constexpr std::int64_t kLastEpoch = (1 << 24) - 1;
// Updates the row in place: replacing it would move it, and change twice as many pages.
constexpr auto kWriteTile =
    "INSERT INTO tiles (job_id, tile, done, content, row_xxh3)"
    " SELECT ?1, ?2, ?3, ?4, ?5 WHERE EXISTS (SELECT 1 FROM jobs WHERE id = ?1)"
    " ON CONFLICT (job_id, tile) DO UPDATE"
    " SET done = excluded.done, content = excluded.content, row_xxh3 = excluded.row_xxh3";
constexpr auto kWriteRevision =
    "INSERT INTO tile_revisions SELECT ?1, ?2, ?3 WHERE EXISTS (SELECT 1 FROM jobs WHERE id = ?1)"
    " ON CONFLICT (job_id, tile) DO UPDATE SET revision = excluded.revision";
constexpr auto kTileChanges =
    "SELECT revision, tile FROM tile_revisions WHERE job_id = ?1 AND revision > ?2 AND tile >= ?4 AND tile < "
    "?5"
    " ORDER BY revision LIMIT ?3";
constexpr auto kDeleteJob = "DELETE FROM jobs WHERE id = ?1";
// Jobs that may have tiles.
constexpr auto kNoteDeleted = "INSERT OR IGNORE INTO deleted_jobs (id) VALUES (?1)";
constexpr auto kForgetDeleted = "DELETE FROM deleted_jobs WHERE id = ?1";
constexpr auto kDeletedJobs = "SELECT id FROM deleted_jobs";
// Whether a deleted job still has tiles.
constexpr auto kHasTiles =
    "SELECT 1 FROM tiles WHERE job_id = ?1 AND NOT EXISTS (SELECT 1 FROM jobs WHERE id = ?1) LIMIT 1";
constexpr auto kDeleteTiles =
    "DELETE FROM tiles WHERE rowid IN (SELECT rowid FROM tiles WHERE job_id = ?1"
    " AND NOT EXISTS (SELECT 1 FROM jobs WHERE id = ?1) LIMIT ?2)";
constexpr auto kTilesDone = "SELECT tile, done FROM tiles WHERE job_id = ?1 ORDER BY tile";
constexpr auto kReadTile = "SELECT done, content, row_xxh3 FROM tiles WHERE job_id = ?1 AND tile = ?2";
constexpr auto kSettledCount = "SELECT count(*) FROM jobs INDEXED BY jobs_by_end WHERE settled = 1";
constexpr auto kFirstSettled =
    "SELECT id FROM jobs WHERE settled = 1 AND finished_ms < ?1 ORDER BY finished_ms LIMIT ?2";

}  // namespace

core::Error damaged(const std::filesystem::path& file, const std::string& how) {
  const std::string folder = file.parent_path().string();
  return {
      ErrorCode::kDataLoss,
      fmt::format("{} is damaged ({}): put back a copy of the state folder; or see with 'tessera-coordinator "
                  "--check {}' which jobs are whole, and keep these with 'tessera-coordinator --salvage {}'",
                  file.string(), how, folder, folder)};
}

namespace {

// The incomplete transaction at the end of the log, if there is one. Fails if the log is damaged.
core::Result<std::optional<std::string>> expect_whole_log(const std::filesystem::path& file) {
  auto log = look_at_log(log_of(file));
  if (!log) return core::fail(log.error());
  if (log->damage) return core::fail(damaged(file, *log->damage));
  return std::move(log->torn_end);
}

std::uint64_t size_of(const std::filesystem::path& file) {
  std::error_code missing;
  const auto size = std::filesystem::file_size(file, missing);
  return missing ? 0 : size;
}

core::Status expect_whole(Database& database, const std::filesystem::path& file) {
  const bool is_large = size_of(file) > JobStore::kCheckedAtOpening;
  const auto damage = is_large ? database.structural_damage_of("jobs") : database.structural_damage();
  if (!damage) return core::fail(damage.error());
  if (!damage->empty()) return core::fail(damaged(file, damage->front()));
  return {};
}

// Without it, the file works as well, but never shrinks.
void make_shrinkable(Database& database, const std::filesystem::path& file) {
  const auto layout = database.read_number("PRAGMA auto_vacuum");
  if (!layout || *layout != 0 || size_of(file) > kConvertedAtOpening) return;
  [[maybe_unused]] const auto by_a_later_start = database.execute(kConvert);
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

core::Status prepare(Database& database, const Wanted& wanted) {
  for (const auto& [statement, sql] : wanted) {
    auto prepared = database.prepare(sql);
    if (!prepared) return core::fail(prepared.error());
    *statement = std::move(*prepared);
  }
  return {};
}

core::Status Reader::prepare_all(int version, bool with_lists) {
  const bool has_settled = version >= kVersionOfSettledJobs;
  const std::string columns = fmt::format(
      "{}, {}, {}, {}, {}, {}, ", kReadJobs, version < kVersionOfWorkerLimits ? "0" : "max_workers",
      version < kVersionOfJobSums ? "NULL" : "row_xxh3",
      version < kVersionOfValidation ? "X'', X''" : "failure_details, submission",
      has_settled ? "owner, producers, settled, bundle_xxh3" : "'', X'', 0, NULL",
      version < kVersionOfTileTargets ? "X''" : "targets");
  const std::string whole = columns + (has_settled ? "bundle" : "X''");
  const std::string jobs = whole + " FROM jobs";
  Wanted wanted{{&list_jobs, jobs + kByAge},
                {&read_job, jobs + " WHERE rowid = ?1"},
                {&tiles_done, kTilesDone},
                {&read_tile, kReadTile}};
  // Files of earlier releases are only looked at as a whole.
  if (!has_settled) return prepare(database, wanted);
  const Wanted of_this_release{
      {&unsettled_jobs, std::string("SELECT id FROM jobs WHERE settled = 0") + kByAge},
      {&job, jobs + " WHERE id = ?1"},
      {&job_of_request, jobs + " WHERE request_id = ?1"},
      {&next_job, whole + ", rowid FROM jobs WHERE rowid > ?1 ORDER BY rowid LIMIT 1"}};
  wanted.insert(wanted.end(), of_this_release.begin(), of_this_release.end());
  const Wanted lists{
      {&page, columns + "NULL, number FROM jobs INDEXED BY jobs_by_number WHERE " + kPage},
      {&page_of_prefix,
       columns + "NULL, number FROM jobs INDEXED BY sqlite_autoindex_jobs_1 WHERE " + kOfPrefix + kPage},
      {&tile_changes, kTileChanges},
      {&settled_count, kSettledCount},
      {&first_settled, kFirstSettled}};
  if (with_lists) wanted.insert(wanted.end(), lists.begin(), lists.end());
  return prepare(database, wanted);
}

core::Status Writer::prepare_all() {
  const std::string validated = std::string(kSetColumns) + kAndThoseOfValidation;
  return prepare(database, {{&insert_job, kInsertJob},
                            {&update_job, std::string(kSetColumns) + kIfOlder},
                            {&end_validation, validated + kIfOlder},
                            {&replace_job, validated + kAndTheOthers + kIfEqual},
                            {&settle_job, std::string(kSetColumns) + kIfNotNewer},
                            {&set_indexed, kSetIndexed},
                            {&delete_job, kDeleteJob},
                            {&note_deleted, kNoteDeleted},
                            {&forget_deleted, kForgetDeleted},
                            {&has_tiles, kHasTiles},
                            {&delete_tiles, kDeleteTiles},
                            {&write_tile, kWriteTile},
                            {&write_revision, kWriteRevision}});
}

core::Status JobStore::Impl::find_deleted_jobs() {
  auto list = reader.database.prepare(kDeletedJobs);
  if (!list) return core::fail(list.error());
  std::vector<std::string> found;
  core::Status read = for_each_row(*list, [&] { found.emplace_back(list->bytes(0)); });
  const core::MutexLock lock(mutex);
  deleted_jobs = std::move(found);
  return read;
}

core::Result<JobStore> JobStore::open(const std::filesystem::path& file, bool may_be_new) {
  if (auto there = expect_database_of_log(file, may_be_new); !there) return core::fail(there.error());
  auto torn_end = expect_whole_log(file);
  if (!torn_end) return core::fail(torn_end.error());
  const bool is_new = is_missing_or_empty(file);
  auto database = Database::open(file);
  if (!database) return core::fail(database.error());
  // Would write to a file that has it already.
  if (auto set = is_new ? database->execute(kLayout) : core::Status(); !set) return core::fail(set.error());
  if (auto usable = expect_usable(*database, file, may_be_new); !usable) return core::fail(usable.error());
  const bool has_rest = size_of(file) > kCheckedAtOpening;
  if (auto whole = expect_whole(*database, file); !whole) return core::fail(whole.error());
  database->checkpoint_wal_on_close();
  if (auto set = database->execute(kPragmas); !set) return core::fail(set.error());
  if (auto current = bring_up_to_date(*database); !current) return core::fail(current.error());
  make_shrinkable(*database, file);
  if (auto counted = database->execute("UPDATE meta SET value = value + 1 WHERE name = 'epoch'"); !counted) {
    return core::fail(counted.error());
  }
  if (auto made = database->execute(kMakeSecret); !made) return core::fail(made.error());
  database->checkpoint_wal();
  auto reader = Database::open_reader(file);
  if (!reader) return core::fail(reader.error());
  auto impl = std::make_unique<Impl>(file, Writer(*std::move(database)), Reader(*std::move(reader)));
  const core::MutexLock lock(impl->reading);
  impl->torn_end = *std::move(torn_end);
  impl->has_rest_to_check = has_rest;
  const auto epoch = read_epoch(impl->writer->database, file);
  if (!epoch) return core::fail(epoch.error());
  impl->epoch = *epoch;
  const auto secret = read_secret(impl->writer->database);
  if (!secret) return core::fail(secret.error());
  impl->secret = *secret;
  if (auto prepared = impl->reader.prepare_all(schema_version(), true); !prepared)
    return core::fail(prepared.error());
  if (auto prepared = impl->writer->prepare_all(); !prepared) return core::fail(prepared.error());
  if (auto found = impl->find_deleted_jobs(); !found) return core::fail(found.error());
  return JobStore(std::move(impl));
}

core::Result<JobStore> JobStore::open_read_only(const std::filesystem::path& file) {
  if (is_missing_or_empty(file)) return core::fail(lost(file));
  auto database = Database::open_read_only(file);
  if (!database) return core::fail(database.error());
  const auto version = expect_readable(*database, file);
  if (!version) return core::fail(version.error());
  auto impl = std::make_unique<Impl>(file, std::nullopt, Reader(*std::move(database)));
  const core::MutexLock lock(impl->reading);
  impl->epoch = read_epoch(impl->reader.database, file).value_or(0);
  impl->secret = read_secret(impl->reader.database).value_or(impl->secret);
  if (auto prepared = impl->reader.prepare_all(*version, false); !prepared)
    return core::fail(prepared.error());
  return JobStore(std::move(impl));
}

core::Status JobStore::copy(const std::filesystem::path& file, const std::filesystem::path& to,
                            bool is_in_use) {
  if (is_missing_or_empty(file)) return core::fail(lost(file));
  // Whoever has it open writes to the log at this moment.
  if (!is_in_use)
    if (const auto whole = expect_whole_log(file); !whole) return core::fail(whole.error());
  auto database = is_in_use ? Database::open_reader(file) : Database::open_read_only(file);
  if (!database) return core::fail(database.error());
  return database->copy_to(to);
}

}  // namespace tessera::store
