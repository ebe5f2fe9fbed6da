#include "server/store/job_store.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <mutex>
#include <set>
#include <system_error>
#include <utility>

#include "server/store/log_damage.hpp"
#include "server/store/row_codec.hpp"
#include "server/store/schema.hpp"
#include "server/store/sqlite.hpp"

namespace tessera::store {

using core::ErrorCode;

namespace {

constexpr auto kPageSize = "PRAGMA page_size = 16384";  // of new files
constexpr auto kPragmas = R"(
  PRAGMA journal_mode = WAL;
  PRAGMA synchronous = FULL;
  PRAGMA foreign_keys = ON;
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
// Up to what earlier releases had not: the limit of workers, and the sum.
constexpr auto kReadJobs =
    "SELECT id, request_id, spec, revision, state, failure, spp, priority, created_ms, finished_ms,"
    " counters, arithmetic, ";
constexpr auto kByAge = " FROM jobs ORDER BY created_ms, rowid";
constexpr auto kByRowid = " FROM jobs WHERE rowid = ?1";
// Each as far as it can be read: the table itself, and its indexes, which name its rows, too.
constexpr const char* kTableScans[] = {"SELECT rowid FROM jobs NOT INDEXED ORDER BY rowid",
                                       "SELECT rowid FROM jobs NOT INDEXED ORDER BY rowid DESC"};
constexpr const char* kIndexScans[] = {
    "SELECT rowid FROM jobs INDEXED BY sqlite_autoindex_jobs_1 ORDER BY id",
    "SELECT rowid FROM jobs INDEXED BY sqlite_autoindex_jobs_1 ORDER BY id DESC"};
// Rows are numbered from 1. Up to here, those that no scan has come to are tried, too.
constexpr std::int64_t kMostTried = 1'000'000;
// A lease's number has room for epochs up to this.
constexpr std::int64_t kLastEpoch = (1 << 24) - 1;
// Changes a row where it stands: replacing it would move it, and change twice as many pages.
constexpr auto kWriteTile =
    "INSERT INTO tiles (job_id, tile, done, content, row_xxh3)"
    " SELECT ?1, ?2, ?3, ?4, ?5 WHERE EXISTS (SELECT 1 FROM jobs WHERE id = ?1)"
    " ON CONFLICT (job_id, tile) DO UPDATE"
    " SET done = excluded.done, content = excluded.content, row_xxh3 = excluded.row_xxh3";
constexpr auto kDeleteJob = "DELETE FROM jobs WHERE id = ?1";
constexpr auto kTilesDone = "SELECT tile, done FROM tiles WHERE job_id = ?1 ORDER BY tile";
constexpr auto kReadTile = "SELECT done, content, row_xxh3 FROM tiles WHERE job_id = ?1 AND tile = ?2";

std::int64_t as_signed(std::uint64_t value) {
  return static_cast<std::int64_t>(value);
}
std::uint64_t as_unsigned(std::int64_t value) {
  return static_cast<std::uint64_t>(value);
}

JobRow read_job(const Statement& row) {
  JobRow job;
  job.id = row.bytes(0);
  job.request_id = row.bytes(1);
  job.spec = row.bytes(2);
  job.revision = as_unsigned(row.integer(3));
  job.state = static_cast<int>(row.integer(4));
  job.failure = row.bytes(5);
  job.spp = static_cast<std::uint32_t>(row.integer(6));
  job.priority = static_cast<int>(row.integer(7));
  job.created_ms = row.integer(8);
  if (!row.is_null(9)) job.finished_ms = row.integer(9);
  job.counters = row.bytes(10);
  job.arithmetic = row.bytes(11);
  job.max_workers = static_cast<std::uint32_t>(row.integer(12));
  // Rows of the first release have no sum.
  job.intact = row.is_null(13) || as_unsigned(row.integer(13)) == row_checksum(job);
  return job;
}

template <typename Take>
core::Status for_each_row(Statement& statement, Take take) {
  auto row = statement.step();
  for (; row && *row; row = statement.step()) take();
  statement.reset();
  if (!row) return core::fail(row.error());
  return {};
}

struct RowidScan {
  std::set<std::int64_t> rowids;
  core::Status complete;  // or why it is not sure that these are all
};

core::Status scan_rowids(Database& database, const char* sql, std::set<std::int64_t>& rowids) {
  auto statement = database.prepare(sql);
  if (!statement) return core::fail(statement.error());
  return for_each_row(*statement, [&] { rowids.insert(statement->integer(0)); });
}

ReadableJobs by_age(ReadableJobs jobs) {
  std::stable_sort(jobs.rows.begin(), jobs.rows.end(),
                   [](const JobRow& a, const JobRow& b) { return a.created_ms < b.created_ms; });
  return jobs;
}

RowidScan scan_jobs(Database& database) {
  RowidScan scan;
  for (const char* const sql : kTableScans) {
    scan.complete = scan_rowids(database, sql, scan.rowids);
    if (scan.complete) return scan;
  }
  for (const char* const sql : kIndexScans)
    [[maybe_unused]] const auto as_far_as_it_goes = scan_rowids(database, sql, scan.rowids);
  return scan;
}

core::Error damaged(const std::filesystem::path& file, const std::string& how) {
  const std::string folder = file.parent_path().string();
  return {
      ErrorCode::kDataLoss,
      fmt::format("{} is damaged ({}): put back a copy of the state folder; or see with 'tessera-coordinator "
                  "--check {}' which jobs are whole, and keep these with 'tessera-coordinator --salvage {}'",
                  file.string(), how, folder, folder)};
}

core::Status expect_whole_log(const std::filesystem::path& file) {
  const auto log = look_at_log(log_of(file));
  if (!log) return core::fail(log.error());
  if (log->damage) return core::fail(damaged(file, *log->damage));
  return {};
}

core::Status expect_whole(Database& database, const std::filesystem::path& file) {
  const auto damage = database.structural_damage();
  if (!damage) return core::fail(damage.error());
  if (!damage->empty()) return core::fail(damaged(file, damage->front()));
  return {};
}

// SQLite's random numbers come from those of the system.
constexpr auto kMakeSecret =
    "INSERT OR IGNORE INTO meta VALUES ('secret_0', random()), ('secret_1', random())";

// Zeros if it was not made yet.
core::Result<std::array<std::uint64_t, 2>> read_secret(Database& database) {
  const auto first = database.read_number("SELECT value FROM meta WHERE name = 'secret_0'");
  if (!first) return core::fail(first.error());
  const auto second = database.read_number("SELECT value FROM meta WHERE name = 'secret_1'");
  if (!second) return core::fail(second.error());
  return std::array{as_unsigned(*first), as_unsigned(*second)};
}

// Without asking SQLite: opening such a file creates it, and reading it empties its log.
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

struct JobStore::Impl {
  Impl(Database opened, std::filesystem::path path) : database(std::move(opened)), file(std::move(path)) {}

  using Wanted = std::pair<Statement*, std::string>;
  core::Status prepare(const std::vector<Wanted>& wanted) {
    for (const auto& [statement, sql] : wanted) {
      auto prepared = database.prepare(sql);
      if (!prepared) return core::fail(prepared.error());
      *statement = std::move(*prepared);
    }
    return {};
  }
  core::Status prepare_reading(int version) {
    const std::string jobs =
        fmt::format("{}{}, {}", kReadJobs, version < kVersionOfWorkerLimits ? "0" : "max_workers",
                    version < kVersionOfJobSums ? "NULL" : "row_xxh3");
    return prepare({{&list_jobs, jobs + kByAge},
                    {&read_job, jobs + kByRowid},
                    {&tiles_done, kTilesDone},
                    {&read_tile, kReadTile}});
  }
  core::Status prepare_writing() {
    return prepare({{&insert_job, kInsertJob},
                    {&update_job, kUpdateJob},
                    {&delete_job, kDeleteJob},
                    {&write_tile, kWriteTile}});
  }

  Database database;
  Statement list_jobs, read_job, tiles_done, read_tile;
  Statement insert_job, update_job, delete_job, write_tile;  // none if it is only looked at
  const std::filesystem::path file;
  std::uint32_t epoch = 0;
  std::array<std::uint64_t, 2> secret{};
  std::mutex mutex;  // guards the database and the statements
};

JobStore::JobStore(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}
JobStore::JobStore(JobStore&&) noexcept = default;
JobStore& JobStore::operator=(JobStore&&) noexcept = default;
JobStore::~JobStore() = default;

core::Result<JobStore> JobStore::open(const std::filesystem::path& file, bool may_be_new) {
  if (auto there = expect_database_of_log(file, may_be_new); !there) return core::fail(there.error());
  if (auto whole = expect_whole_log(file); !whole) return core::fail(whole.error());
  auto database = Database::open(file);
  if (!database) return core::fail(database.error());
  if (auto set = database->execute(kPageSize); !set) return core::fail(set.error());
  if (auto usable = expect_usable(*database, file, may_be_new); !usable) return core::fail(usable.error());
  if (auto whole = expect_whole(*database, file); !whole) return core::fail(whole.error());
  database->fold_log_on_close();
  if (auto set = database->execute(kPragmas); !set) return core::fail(set.error());
  if (auto current = bring_up_to_date(*database); !current) return core::fail(current.error());
  if (auto counted = database->execute("UPDATE meta SET value = value + 1 WHERE name = 'epoch'"); !counted) {
    return core::fail(counted.error());
  }
  if (auto made = database->execute(kMakeSecret); !made) return core::fail(made.error());
  database->fold_log();
  auto impl = std::make_unique<Impl>(std::move(*database), file);
  const auto epoch = read_epoch(impl->database, file);
  if (!epoch) return core::fail(epoch.error());
  impl->epoch = *epoch;
  const auto secret = read_secret(impl->database);
  if (!secret) return core::fail(secret.error());
  impl->secret = *secret;
  if (auto prepared = impl->prepare_reading(schema_version()); !prepared) return core::fail(prepared.error());
  if (auto prepared = impl->prepare_writing(); !prepared) return core::fail(prepared.error());
  return JobStore(std::move(impl));
}

core::Result<JobStore> JobStore::open_untouched(const std::filesystem::path& file) {
  if (is_missing_or_empty(file)) return core::fail(lost(file));
  auto database = Database::open_untouched(file);
  if (!database) return core::fail(database.error());
  const auto version = expect_readable(*database, file);
  if (!version) return core::fail(version.error());
  auto impl = std::make_unique<Impl>(std::move(*database), file);
  impl->epoch = read_epoch(impl->database, file).value_or(0);
  impl->secret = read_secret(impl->database).value_or(impl->secret);
  if (auto prepared = impl->prepare_reading(*version); !prepared) return core::fail(prepared.error());
  return JobStore(std::move(impl));
}

std::uint32_t JobStore::epoch() const {
  return impl_->epoch;
}

core::Status JobStore::continue_from(std::uint32_t epoch) {
  const std::lock_guard lock(impl_->mutex);
  return impl_->database.execute(
      fmt::format("UPDATE meta SET value = {} WHERE name = 'epoch' AND value < {}", epoch, epoch));
}

core::Status JobStore::empty_log() {
  const std::lock_guard lock(impl_->mutex);
  return impl_->database.empty_log();
}

core::Result<std::vector<std::string>> JobStore::structural_damage() {
  const std::lock_guard lock(impl_->mutex);
  auto damage = impl_->database.structural_damage();
  const auto log = look_at_log(log_of(impl_->file));
  if (!log) return core::fail(log.error());
  if (damage && log->damage) damage->push_back(*log->damage);
  return damage;
}

std::array<std::uint64_t, 2> JobStore::secret() const {
  return impl_->secret;
}

core::Status JobStore::insert_job(const JobRow& job) {
  const std::lock_guard lock(impl_->mutex);
  Statement& insert = impl_->insert_job;
  insert.bind_text(1, job.id).bind_blob(3, job.spec).bind(4, as_signed(job.revision)).bind(5, job.state);
  insert.bind_text(6, job.failure).bind(7, job.spp).bind(8, job.priority).bind(9, job.created_ms);
  job.request_id.empty() ? insert.bind_null(2) : insert.bind_text(2, job.request_id);
  job.finished_ms ? insert.bind(10, *job.finished_ms) : insert.bind_null(10);
  insert.bind_blob(11, job.counters).bind_text(12, job.arithmetic).bind(13, job.max_workers);
  insert.bind(14, as_signed(row_checksum(job)));
  auto inserted = insert.run();
  if (inserted) impl_->database.fold_log();
  return inserted;
}

core::Status JobStore::update_job(const JobRow& job) {
  const std::lock_guard lock(impl_->mutex);
  Statement& update = impl_->update_job;
  update.bind_text(1, job.id).bind(2, as_signed(job.revision)).bind(3, job.state).bind_text(4, job.failure);
  update.bind(5, job.spp).bind(6, job.priority);
  job.finished_ms ? update.bind(7, *job.finished_ms) : update.bind_null(7);
  update.bind_blob(8, job.counters).bind_text(9, job.arithmetic).bind(10, job.max_workers);
  update.bind(11, as_signed(row_checksum(job)));
  return update.run();
}

core::Status JobStore::delete_job(const std::string& id) {
  const std::lock_guard lock(impl_->mutex);
  return impl_->delete_job.bind_text(1, id).run();
}

core::Result<std::vector<JobRow>> JobStore::jobs() {
  const std::lock_guard lock(impl_->mutex);
  std::vector<JobRow> rows;
  Statement& list = impl_->list_jobs;
  const auto read = for_each_row(list, [&] { rows.push_back(read_job(list)); });
  if (!read) return core::fail(read.error());
  return rows;
}

core::Result<ReadableJobs> JobStore::readable_jobs() {
  const std::lock_guard lock(impl_->mutex);
  const RowidScan scan = scan_jobs(impl_->database);
  core::Status complete = scan.complete;
  ReadableJobs jobs;
  const auto read = [&](std::int64_t rowid) {
    Statement& statement = impl_->read_job.bind(1, rowid);
    const auto row = statement.step();
    if (!row) complete = core::fail(row.error());
    const bool is_here = row && *row;
    if (is_here) jobs.rows.push_back(read_job(statement));
    statement.reset();
    return is_here;
  };
  for (const std::int64_t rowid : scan.rowids) jobs.unreadable += read(rowid) ? 0 : 1;
  if (!scan.complete && !scan.rowids.empty()) {
    for (std::int64_t rowid = 1; rowid <= std::min(*scan.rowids.rbegin(), kMostTried); ++rowid)
      if (!scan.rowids.contains(rowid)) read(rowid);
  }
  if (complete) return by_age(std::move(jobs));
  if (jobs.rows.empty()) return core::fail(complete.error());
  jobs.unreadable = std::max<std::size_t>(jobs.unreadable, 1);
  return by_age(std::move(jobs));
}

core::Status JobStore::write_tiles(const std::vector<TileRow>& tiles) {
  const std::lock_guard lock(impl_->mutex);
  auto transaction = Transaction::begin(impl_->database);
  if (!transaction) return core::fail(transaction.error());
  for (const TileRow& tile : tiles) {
    const std::string done = encode_ranges(tile.done);
    Statement& write = impl_->write_tile;
    write.bind_text(1, tile.job_id).bind(2, tile.tile).bind_blob(3, done).bind_blob(4, tile.content);
    write.bind(5, as_signed(row_checksum(tile, done)));
    if (auto written = write.run(); !written) return written;
  }
  return transaction->commit();
}

core::Result<std::map<int, std::vector<core::SampleRange>>> JobStore::tiles_done(const std::string& job_id) {
  const std::lock_guard lock(impl_->mutex);
  std::map<int, std::vector<core::SampleRange>> tiles;
  Statement& list = impl_->tiles_done.bind_text(1, job_id);
  const auto read =
      for_each_row(list, [&] { tiles[static_cast<int>(list.integer(0))] = decode_ranges(list.bytes(1)); });
  if (!read) return core::fail(read.error());
  return tiles;
}

core::Result<std::optional<TileRow>> JobStore::tile(const std::string& job_id, int tile) {
  const std::lock_guard lock(impl_->mutex);
  Statement& read = impl_->read_tile.bind_text(1, job_id).bind(2, tile);
  const auto row = read.step();
  std::optional<TileRow> found;
  bool intact = true;
  if (row && *row) {
    found = TileRow{job_id, tile, decode_ranges(read.bytes(0)), std::string(read.bytes(1))};
    intact = as_unsigned(read.integer(2)) == row_checksum(*found, read.bytes(0));
  }
  read.reset();
  if (!row) return core::fail(row.error());
  if (intact) return found;
  return core::fail(ErrorCode::kDataLoss,
                    fmt::format("{}: tile {} of job {} is damaged", impl_->file.string(), tile, job_id));
}

}  // namespace tessera::store
