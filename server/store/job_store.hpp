// SPDX-License-Identifier: Apache-2.0
// The durable state of a coordinator in one SQLite file: jobs, and the film tiles they have so far.
//
// Specs and tile contents are opaque bytes here. A tile's row is self-contained: it holds exactly the samples
// in its `done`, so that rows written at different times never contradict each other. Thread-safe; every call
// blocks for the disk.
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "core/base/error.hpp"
#include "core/film/region.hpp"

namespace tessera::store {

class Database;

struct JobRow {
  std::string id;
  std::string request_id;  // empty for none, otherwise unique
  std::string spec;        // immutable
  // Mutable columns; the revision grows with every change.
  std::uint64_t revision = 0;
  int state = 0;
  std::string failure;
  std::uint32_t spp = 0;
  int priority = 0;
  std::uint32_t max_workers = 0;
  std::int64_t created_ms = 0;  // since 1970-01-01 UTC
  std::optional<std::int64_t> finished_ms;
  std::string counters;    // opaque; of the film when the row was written
  std::string arithmetic;  // determinism fingerprint of its workers; empty before the first samples
  bool intact = true;      // false if the checksum does not match: no column can be trusted

  bool operator==(const JobRow&) const = default;
};

struct TileRow {
  std::string job_id;
  int tile = 0;
  std::vector<core::SampleRange> done;  // the samples in the content: ascending, disjoint
  std::string content;

  bool operator==(const TileRow&) const = default;
};

// The readable rows of a damaged job list.
struct ReadableJobs {
  std::vector<JobRow> rows;    // oldest first; a damaged list may have the same job twice
  std::size_t unreadable = 0;  // a lower bound on the unreadable rows
};

class JobStore {
 public:
  // Opens or creates the file and increments the epoch. Reads the whole file. DATA_LOSS if it is damaged,
  // since writes could destroy intact parts; it is never replaced by an empty one. FAILED_PRECONDITION if a
  // later release wrote it. Unless `may_be_new`, a missing or empty file is DATA_LOSS, too, as is a log
  // without its database. A file that is refused is left unchanged, with its log.
  static core::Result<JobStore> open(const std::filesystem::path& file, bool may_be_new = true);
  // Opens the file for reading while nobody else has it open. Writes nothing. Opens damaged files as far as
  // they can be read, and files of earlier releases without upgrading them. All functions that write fail.
  static core::Result<JobStore> open_read_only(const std::filesystem::path& file);
  JobStore(JobStore&&) noexcept;
  JobStore& operator=(JobStore&&) noexcept;
  ~JobStore();

  // How often this state was opened, from 1; 0 if that cannot be read from a file that is open for reading
  // only.
  std::uint32_t epoch() const;
  // The incomplete transaction at the end of the log when it was opened, which does not count
  // (log_damage.hpp).
  const std::optional<std::string>& torn_end() const;
  // DATA_LOSS if the file was removed since it was opened: all later writes are lost when it is closed.
  core::Status expect_file() const;
  // Makes later epochs greater than this one.
  core::Status continue_from(std::uint32_t epoch);
  // Writes the whole log into the file and truncates the log. UNAVAILABLE if another program has the file
  // open.
  core::Status truncate_wal();
  // The damage to the file's structure, besides its rows: one sentence each; empty if there is none.
  core::Result<std::vector<std::string>> structural_damage();

  // Random bits, made once with the file.
  std::array<std::uint64_t, 2> secret() const;

  core::Status insert_job(const JobRow& job);
  // Writes the mutable columns, unless the store has a later revision or the job was deleted.
  core::Status update_job(const JobRow& job);
  // Deletes the job. Does nothing if there is no such job. remove_deleted_tiles() removes its tiles, also
  // after a restart; the id must not be reused.
  core::Status delete_job(const std::string& id);
  // Removes some tiles of deleted jobs, a few in each transaction: all tiles of a large job would take
  // seconds.
  core::Status remove_deleted_tiles();
  // Oldest first.
  core::Result<std::vector<JobRow>> jobs();
  // The same of a damaged file, row by row. Fails only if no row can be read.
  core::Result<ReadableJobs> readable_jobs();

  // Writes all of these tiles or none. Tiles of deleted jobs are skipped.
  core::Status write_tiles(const std::vector<TileRow>& tiles);
  // The samples that are done in each stored tile, by tile number.
  core::Result<std::map<int, std::vector<core::SampleRange>>> tiles_done(const std::string& job_id);
  // Empty if the tile has no row. DATA_LOSS if the row's checksum does not match.
  core::Result<std::optional<TileRow>> tile(const std::string& job_id, int tile);

 private:
  struct Impl;
  explicit JobStore(std::unique_ptr<Impl> impl);

  std::unique_ptr<Impl> impl_;
};

}  // namespace tessera::store
