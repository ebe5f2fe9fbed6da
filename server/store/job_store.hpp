// SPDX-License-Identifier: Apache-2.0
// The durable state of a coordinator in one SQLite file: jobs, and the film tiles they have so far.
//
// Specs and tile contents are opaque bytes here. A tile's row is self-contained: it holds exactly the samples
// in its `done`, so that rows written at different times never contradict each other.
//
// One connection writes, and concurrent changes share its transactions (group_commit.hpp). Another one reads,
// so that readers never wait for writers. Thread-safe; every call blocks for the disk.
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <limits>
#include <map>
#include <memory>
#include <optional>
#include <stop_token>
#include <string>
#include <vector>

#include "core/base/error.hpp"
#include "core/film/region.hpp"

namespace tessera::store {

class Database;

struct JobRow {
  std::string id;
  std::string request_id;  // empty for none, otherwise unique
  std::string spec;        // says the same once the job is validated
  // Immutable once the job is validated; not part of the spec, since it can be large. Rows of earlier
  // releases have it in their spec. Empty where a function says so.
  std::string bundle{};
  std::string owner{};  // immutable; empty in rows of earlier releases that are not settled
  // Mutable columns; the revision grows with every change.
  std::uint64_t revision = 0;
  int state = 0;
  std::string failure;
  std::uint32_t spp = 0;
  int priority = 0;
  std::uint32_t max_workers = 0;
  std::int64_t created_ms = 0;  // since 1970-01-01 UTC
  std::optional<std::int64_t> finished_ms;
  std::string counters;           // opaque; of the film when the row was written
  std::string arithmetic;         // determinism fingerprint of its workers; empty before the first samples
  std::string failure_details{};  // opaque; why the job failed, for programs
  std::string submission{};       // opaque; what is validated, while it is
  // Opaque: who may have rendered samples that nobody has verified.
  std::string producers{};
  // Opaque: the tiles that are to get another number of samples than `spp`.
  std::string targets{};
  // The job is finished, and a start of the coordinator need not look at it. Not covered by the checksum: the
  // worst that a wrong value does is to look, or to find out later that a tile is missing.
  bool settled = false;
  bool intact = true;  // false if the checksum does not match: no column can be trusted

  bool operator==(const JobRow&) const = default;
};

struct TileRow {
  std::string job_id;
  int tile = 0;                         // of those of all images of the job, image by image
  std::vector<core::SampleRange> done;  // the samples in the content: ascending, disjoint
  std::string content;
  // The revision of these samples (events/revision.hpp), which no other tile of the job has. Written, and
  // read by tile_changes() only. 0: that of the tile's place in the image, less than all others.
  std::uint64_t revision = 0;

  bool operator==(const TileRow&) const = default;
};

struct TileChange {
  std::uint64_t revision = 0;
  int tile = 0;
  bool operator==(const TileChange&) const = default;
};

// An entry of the quarantine. The content is opaque.
struct QuarantineRow {
  std::string id;
  std::string content;
  bool intact = true;  // false if the checksum does not match

  bool operator==(const QuarantineRow&) const = default;
};

// Which jobs to list: newest first. The store numbers jobs in the order of their insertion.
struct JobQuery {
  // Only jobs before this number.
  std::optional<std::int64_t> before_number;
  std::string id_prefix;
  std::optional<std::string> owner;
  std::optional<std::int64_t> created_from_ms, created_before_ms;
  // The states of settled jobs, as bits. Jobs that are not settled match in any case: their rows may not have
  // their current state. 0 for all.
  std::uint32_t states = 0;
};

// The readable rows of a damaged job list.
struct ReadableJobs {
  std::vector<JobRow> rows;    // oldest first; a damaged list may have the same job twice
  std::size_t unreadable = 0;  // a lower bound on the unreadable rows
};

class JobStore {
 public:
  // Opens or creates the file and increments the epoch. DATA_LOSS if it is damaged, since writes could
  // destroy intact parts; it is never replaced by an empty one. Reads a file of up to kCheckedAtOpening as a
  // whole; of a larger one only the jobs, and check_rest() must follow. FAILED_PRECONDITION if a
  // later release wrote it. Unless `may_be_new`, a missing or empty file is DATA_LOSS, too, as is a log
  // without its database. A file that is refused is left unchanged, with its log.
  static core::Result<JobStore> open(const std::filesystem::path& file, bool may_be_new = true);
  // Opens the file for reading while nobody else has it open. Writes nothing. Opens damaged files as far as
  // they can be read, and files of earlier releases without upgrading them. All functions that write fail.
  static core::Result<JobStore> open_read_only(const std::filesystem::path& file);
  // Writes the content of a file, as it is at one moment, to a file that does not exist yet. `is_in_use`:
  // whether another process has the file open; it reads and writes meanwhile, and its log grows until the
  // copy is made. DATA_LOSS if the file is missing, or if the log of a file that is not in use is damaged.
  // Other damage is copied.
  static core::Status copy(const std::filesystem::path& file, const std::filesystem::path& to,
                           bool is_in_use);
  static constexpr std::uint64_t kCheckedAtOpening = std::uint64_t{256} << 20;
  JobStore(JobStore&&) noexcept;
  JobStore& operator=(JobStore&&) noexcept;
  ~JobStore();

  // How often this state was opened, from 1; 0 if that cannot be read from a file that is open for reading
  // only.
  std::uint32_t epoch() const;
  const std::filesystem::path& file() const;
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

  // Whether open() has not read the whole file.
  bool has_rest_to_check() const;
  // Reads the whole file while others read and write it: about a gigabyte in a second. DATA_LOSS if its
  // structure is damaged; from then on all functions that write fail with the same error. CANCELLED if it is
  // told to stop. The log grows meanwhile.
  core::Status check_rest(const std::stop_token& stop);
  // The number of transactions so far.
  std::uint64_t transactions() const;

  // Random bits, made once with the file.
  std::array<std::uint64_t, 2> secret() const;

  core::Status insert_job(const JobRow& job);
  // Writes the mutable columns and the spec, unless the store has a later revision or the job was deleted.
  core::Status update_job(const JobRow& job);
  // The same, with the columns that change only when a validation ends: the submission and the bundle.
  core::Status end_validation(const JobRow& job);
  // Writes all columns but those of the submission (id, request_id, created_ms), if the store has exactly
  // this revision of the job. Returns whether it has.
  core::Result<bool> replace_job(const JobRow& job, std::uint64_t revision);
  // The same for jobs whose revision stays, in one transaction.
  core::Status rewrite_jobs(const std::vector<JobRow>& jobs);
  // Writes the mutable columns of jobs in one transaction, except where the store has a later revision.
  core::Status settle_jobs(const std::vector<JobRow>& jobs);
  // Deletes these jobs, all or none. Does nothing where there is no such job. remove_deleted_tiles() removes
  // their tiles, also after a restart; the ids must not be reused.
  core::Status delete_jobs(const std::vector<std::string>& ids);
  core::Status delete_job(const std::string& id) { return delete_jobs({id}); }
  // Removes some tiles of deleted jobs, a few in each transaction: all tiles of a large job would take
  // seconds. When none are left, gives some of the free pages back to the file system.
  core::Status remove_deleted_tiles();

  // Oldest first.
  core::Result<std::vector<JobRow>> jobs();
  // The ids of those that are not settled, oldest first.
  core::Result<std::vector<std::string>> unsettled_jobs();
  // Empty if there is none.
  core::Result<std::optional<JobRow>> job(const std::string& id);
  core::Result<std::optional<JobRow>> job_of_request(const std::string& request_id);
  // Passes on the first `limit` jobs of the query with their numbers, without their bundles. `take` must not
  // call the store.
  core::Status list_jobs(const JobQuery& query, std::size_t limit,
                         const std::function<void(JobRow, std::int64_t)>& take);
  // Passes on all jobs, in the order in which they were inserted, also those that are inserted meanwhile.
  // Others read and write meanwhile, and `take` may call the store.
  core::Status for_each_job(const std::function<void(const JobRow&)>& take);
  // The number of settled jobs, and the first of them to finish, at most `limit`; with a time, only those
  // that finished before it.
  core::Result<std::uint64_t> settled_count();
  core::Result<std::vector<std::string>> first_settled(std::optional<std::int64_t> finished_before_ms,
                                                       std::size_t limit);
  // The same of a damaged file, row by row. Fails only if no row can be read.
  core::Result<ReadableJobs> readable_jobs();

  // Writes all of these tiles or none. Tiles of deleted jobs are skipped.
  core::Status write_tiles(const std::vector<TileRow>& tiles);
  // The samples that are done in each stored tile, by tile number.
  core::Result<std::map<int, std::vector<core::SampleRange>>> tiles_done(const std::string& job_id);
  // The tiles in [first, end) that changed after `since`, oldest first, with their revisions: at most `most`.
  core::Result<std::vector<TileChange>> tile_changes(const std::string& job_id, std::uint64_t since,
                                                     std::size_t most, int first = 0,
                                                     int end = std::numeric_limits<int>::max());
  // Empty if the tile has no row. DATA_LOSS if the row's checksum does not match.
  core::Result<std::optional<TileRow>> tile(const std::string& job_id, int tile);

  // Writes an entry of the quarantine, or replaces that of this id.
  core::Status write_quarantine(const std::string& id, const std::string& content);
  // Does nothing if there is no such entry.
  core::Status delete_quarantine(const std::string& id);
  // Ordered by id. Empty in a file of an earlier release.
  core::Result<std::vector<QuarantineRow>> quarantine();

 private:
  struct Impl;
  explicit JobStore(std::unique_ptr<Impl> impl);

  std::unique_ptr<Impl> impl_;
};

}  // namespace tessera::store
