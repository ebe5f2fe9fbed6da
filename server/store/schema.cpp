// SPDX-License-Identifier: Apache-2.0
#include "server/store/schema.hpp"

#include <fmt/format.h>

#include <iterator>

namespace tessera::store {

using core::ErrorCode;

namespace {

// Step i migrates from version i to version i + 1. Released steps must not change.
constexpr const char* kSteps[] = {
    R"(
  CREATE TABLE meta (name TEXT PRIMARY KEY, value INTEGER NOT NULL);
  INSERT INTO meta VALUES ('epoch', 0);
  CREATE TABLE jobs (
    id TEXT PRIMARY KEY, request_id TEXT, spec BLOB NOT NULL, revision INTEGER NOT NULL, state INTEGER NOT NULL,
    failure TEXT NOT NULL, spp INTEGER NOT NULL, priority INTEGER NOT NULL, created_ms INTEGER NOT NULL,
    finished_ms INTEGER, counters BLOB NOT NULL, arithmetic TEXT NOT NULL);
  CREATE UNIQUE INDEX jobs_by_request_id ON jobs (request_id);
  CREATE TABLE tiles (
    job_id TEXT NOT NULL REFERENCES jobs (id) ON DELETE CASCADE, tile INTEGER NOT NULL, done BLOB NOT NULL,
    content BLOB NOT NULL, row_xxh3 INTEGER NOT NULL, PRIMARY KEY (job_id, tile));
)",
    // Checksums of jobs.
    "ALTER TABLE jobs ADD COLUMN row_xxh3 INTEGER",
    // Limits on workers.
    "ALTER TABLE jobs ADD COLUMN max_workers INTEGER NOT NULL DEFAULT 0",
    // The last changes of tiles, in their order, without their samples.
    R"(
  CREATE TABLE tile_revisions (
    job_id TEXT NOT NULL, tile INTEGER NOT NULL, revision INTEGER NOT NULL,
    PRIMARY KEY (job_id, tile)) WITHOUT ROWID;
  INSERT INTO tile_revisions SELECT job_id, tile, tile + 1 FROM tiles;
  CREATE INDEX tiles_by_revision ON tile_revisions (job_id, revision);
  CREATE TRIGGER tile_deleted AFTER DELETE ON tiles BEGIN
    DELETE FROM tile_revisions WHERE job_id = OLD.job_id AND tile = OLD.tile;
  END;
)",
    // The quarantine.
    "CREATE TABLE quarantine (id TEXT PRIMARY KEY, content BLOB NOT NULL, row_xxh3 INTEGER NOT NULL)",
    // Why jobs failed, for programs, and what is validated next.
    R"(
  ALTER TABLE jobs ADD COLUMN failure_details BLOB NOT NULL DEFAULT x'';
  ALTER TABLE jobs ADD COLUMN submission BLOB NOT NULL DEFAULT x'';
)",
    // Settled jobs, which a start need not read. Those of earlier releases are settled by the next start. The
    // bundle is the last column, so that it is not read with the others.
    R"(
  ALTER TABLE jobs ADD COLUMN owner TEXT NOT NULL DEFAULT '';
  ALTER TABLE jobs ADD COLUMN producers BLOB NOT NULL DEFAULT X'';
  ALTER TABLE jobs ADD COLUMN settled INTEGER NOT NULL DEFAULT 0;
  ALTER TABLE jobs ADD COLUMN number INTEGER NOT NULL DEFAULT 0;
  ALTER TABLE jobs ADD COLUMN bundle_xxh3 INTEGER;
  ALTER TABLE jobs ADD COLUMN bundle BLOB NOT NULL DEFAULT X'';
  UPDATE jobs SET number = ordered.number
    FROM (SELECT rowid AS r, row_number() OVER (ORDER BY created_ms, rowid) AS number FROM jobs) AS ordered
    WHERE jobs.rowid = ordered.r;
  CREATE INDEX jobs_by_number ON jobs (number, settled, state, owner, created_ms);
  CREATE INDEX jobs_unsettled ON jobs (created_ms) WHERE settled = 0;
  CREATE INDEX jobs_by_end ON jobs (finished_ms) WHERE settled = 1;
  CREATE TABLE deleted_jobs (id TEXT PRIMARY KEY) WITHOUT ROWID;
  INSERT INTO deleted_jobs
    SELECT DISTINCT job_id FROM tiles WHERE NOT EXISTS (SELECT 1 FROM jobs WHERE id = job_id);
)",
    // Tiles with targets of their own. Tiles of several images need no columns: they are numbered in one
    // sequence, so that a key (job_id, tile) is one of job, image and tile. SQLite reads an empty blob behind
    // the bundle without that.
    "ALTER TABLE jobs ADD COLUMN targets BLOB NOT NULL DEFAULT x''",
};

core::Error of_another_release(const std::filesystem::path& file, std::int64_t version) {
  return {ErrorCode::kFailedPrecondition,
          fmt::format("{} was written by a later release of Tessera (schema {}, this one has {}): use that "
                      "release, or another folder with --state",
                      file.string(), version, schema_version())};
}

core::Status expect_empty(Database& database, const std::filesystem::path& file) {
  const auto tables = database.read_number("SELECT count(*) FROM sqlite_master");
  if (!tables) return core::fail(tables.error());
  if (*tables == 0) return {};
  return core::fail(
      ErrorCode::kFailedPrecondition,
      fmt::format("{} is a database of another program: choose another folder with --state", file.string()));
}

}  // namespace

core::Error lost(const std::filesystem::path& file) {
  return {ErrorCode::kDataLoss,
          fmt::format("{} is missing or empty, though its log or the files of its jobs are in {}: put back a "
                      "copy of the state folder, or move the folder away to start without its jobs",
                      file.string(), file.parent_path().string())};
}

int schema_version() {
  return static_cast<int>(std::size(kSteps));
}

core::Status expect_usable(Database& database, const std::filesystem::path& file, bool may_be_new) {
  const auto version = database.read_number("PRAGMA user_version");
  if (!version) return core::fail(version.error());
  if (*version < 0 || *version > schema_version()) return core::fail(of_another_release(file, *version));
  if (*version > 0) return {};
  if (auto empty = expect_empty(database, file); !empty) return empty;
  if (!may_be_new) return core::fail(lost(file));
  return {};
}

core::Status bring_up_to_date(Database& database) {
  const auto version = database.read_number("PRAGMA user_version");
  if (!version) return core::fail(version.error());
  if (*version == schema_version()) return {};
  auto transaction = Transaction::begin(database);
  if (!transaction) return core::fail(transaction.error());
  for (int step = static_cast<int>(*version); step < schema_version(); ++step) {
    if (auto taken = database.execute(kSteps[step]); !taken) return taken;
  }
  const auto note = fmt::format("PRAGMA user_version = {}", schema_version());
  if (auto noted = database.execute(note); !noted) return noted;
  return transaction->commit();
}

core::Result<int> expect_readable(Database& database, const std::filesystem::path& file) {
  const auto version = database.read_number("PRAGMA user_version");
  if (!version) return core::fail(version.error());
  if (*version == 0) return core::fail(lost(file));
  if (*version < 0 || *version > schema_version()) return core::fail(of_another_release(file, *version));
  return static_cast<int>(*version);
}

}  // namespace tessera::store
