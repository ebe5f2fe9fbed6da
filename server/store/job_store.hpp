// SPDX-License-Identifier: Apache-2.0
// What the coordinator remembers across a crash: jobs, and the film tiles they have so far, in one SQLite
// file.
//
// Specs and tile contents are opaque bytes here. A tile's row stands by itself: its content is of exactly the
// samples in its `done`, so that rows written at different moments never contradict each other.
// Thread-safe; every call blocks for the disk.
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
  std::string request_id;  // empty for none; unique otherwise
  std::string spec;        // never changes
  // What may change comes with a revision that grows with every change.
  std::uint64_t revision = 0;
  int state = 0;
  std::string failure;
  std::uint32_t spp = 0;
  int priority = 0;
  std::uint32_t max_workers = 0;
  std::int64_t created_ms = 0;  // since 1970-01-01 UTC
  std::optional<std::int64_t> finished_ms;
  std::string counters;    // opaque; of the film as it was when the row was written
  std::string arithmetic;  // fingerprint of the workers that rendered it; empty before
  bool intact = true;      // false if the row is not what was written: nothing in it can be relied on

  bool operator==(const JobRow&) const = default;
};

struct TileRow {
  std::string job_id;
  int tile = 0;
  std::vector<core::SampleRange> done;  // the samples in it: ascending, disjoint
  std::string content;

  bool operator==(const TileRow&) const = default;
};

// What of a list can be read.
struct ReadableJobs {
  std::vector<JobRow> rows;    // by age, oldest first; a damaged list may have the same job twice
  std::size_t unreadable = 0;  // at least so many more
};

class JobStore {
 public:
  // Opens or creates the file and counts one more epoch. Reads all of it: a damaged one is DATA_LOSS, since
  // writing to it could spoil what is whole, and is never replaced by an empty one. FAILED_PRECONDITION if it
  // was written by a later release. Unless `may_be_new`, one that is missing or empty is DATA_LOSS, too, as
  // is one of which there is only the log. What is refused is left as it was, log included.
  static core::Result<JobStore> open(const std::filesystem::path& file, bool may_be_new = true);
  // For looking at it while nobody else has it open: writes nothing, and opens a damaged one as far as that
  // can be read, and one of an earlier release as it is. Everything that changes something fails.
  static core::Result<JobStore> open_read_only(const std::filesystem::path& file);
  JobStore(JobStore&&) noexcept;
  JobStore& operator=(JobStore&&) noexcept;
  ~JobStore();

  // How often this state was opened, from 1; 0 if that cannot be read from one that is only looked at.
  std::uint32_t epoch() const;
  // What was missing of its log's end when it was opened, and so does not count (log_damage.hpp).
  const std::optional<std::string>& torn_end() const;
  // DATA_LOSS if the file was removed since it was opened: what is written now is lost when it is closed.
  core::Status expect_file() const;
  // Makes later epochs greater than this one.
  core::Status continue_from(std::uint32_t epoch);
  // Writes everything into the file itself, which then stands without its log. UNAVAILABLE if another program
  // is in the way.
  core::Status truncate_wal();
  // What is wrong with the file apart from its rows: a sentence for each; empty if it is whole.
  core::Result<std::vector<std::string>> structural_damage();

  // Random bits, the same for as long as the file lives.
  std::array<std::uint64_t, 2> secret() const;

  core::Status insert_job(const JobRow& job);
  // Writes what may change, unless the store has a later revision or no such job any more.
  core::Status update_job(const JobRow& job);
  // Forgets the job. Nothing happens if there is no such job. remove_deleted_tiles() removes its tiles, also
  // after a restart; no other job may have its id.
  core::Status delete_job(const std::string& id);
  // Removes some tiles of deleted jobs, a few in each transaction: all of a large job take seconds.
  core::Status remove_deleted_tiles();
  // By age, oldest first.
  core::Result<std::vector<JobRow>> jobs();
  // The same of a damaged file, row by row. Fails only where not a single one can be read.
  core::Result<ReadableJobs> readable_jobs();

  // Writes all of these tiles or none. Tiles of jobs that are no longer here are skipped.
  core::Status write_tiles(const std::vector<TileRow>& tiles);
  // What is done of each tile that has a row, by tile number.
  core::Result<std::map<int, std::vector<core::SampleRange>>> tiles_done(const std::string& job_id);
  // Absent if it has no row. DATA_LOSS if the row is not what was written.
  core::Result<std::optional<TileRow>> tile(const std::string& job_id, int tile);

 private:
  struct Impl;
  explicit JobStore(std::unique_ptr<Impl> impl);

  std::unique_ptr<Impl> impl_;
};

}  // namespace tessera::store
