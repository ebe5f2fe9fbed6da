// What the coordinator remembers across a crash: jobs, and the film tiles they have so far, in one SQLite
// file.
//
// Specs and tile contents are opaque bytes here. A tile's row stands by itself: its content is of exactly the
// samples in its `done`, so that rows written at different moments never contradict each other.
// Thread-safe; every call blocks for the disk.
#pragma once

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
  std::int64_t created_ms = 0;  // since 1970-01-01 UTC
  std::optional<std::int64_t> finished_ms;
  std::string counters;    // opaque; of the film as it was when the row was written
  std::string arithmetic;  // fingerprint of the workers that rendered it; empty before

  bool operator==(const JobRow&) const = default;
};

struct TileRow {
  std::string job_id;
  int tile = 0;
  std::vector<core::SampleRange> done;  // the samples in it: ascending, disjoint
  std::string content;

  bool operator==(const TileRow&) const = default;
};

class JobStore {
 public:
  // Opens or creates the file and counts one more epoch. DATA_LOSS if the file is there but not readable, or
  // was written by a later release: it is never replaced by an empty one.
  static core::Result<JobStore> open(const std::filesystem::path& file);
  JobStore(JobStore&&) noexcept;
  JobStore& operator=(JobStore&&) noexcept;
  ~JobStore();

  // How often this state was opened, from 1.
  std::uint32_t epoch() const;

  core::Status insert_job(const JobRow& job);
  // Writes what may change, unless the store has a later revision or no such job any more.
  core::Status update_job(const JobRow& job);
  // Forgets the job and its tiles. Nothing happens if there is no such job.
  core::Status delete_job(const std::string& id);
  // By age, oldest first.
  core::Result<std::vector<JobRow>> jobs();

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
