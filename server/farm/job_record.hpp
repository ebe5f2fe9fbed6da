// SPDX-License-Identifier: Apache-2.0
// One job: what the coordinator keeps of it besides the scheduler's state. Plain data; guarded by the
// state lock.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "server/blobs/blob_claims.hpp"
#include "server/film/job_film.hpp"
#include "server/scheduler/scheduler.hpp"
#include "server/store/job_store.hpp"
#include "tessera/v1/types.pb.h"

namespace tessera::farm {

struct JobRecord {
  // The job as submitted: id, name, submitter, settings, bundle, display, priority, max_workers and
  // created_at. Never changes.
  std::shared_ptr<const v1::Job> spec;
  std::string request_id;
  blobs::BlobClaims::Hold files;  // the files of the bundle

  // Incremented with every change of what the store keeps of the job besides its tiles.
  std::uint64_t revision = 1;
  std::uint64_t stored_revision = 0;
  std::optional<std::int64_t> finished_ms;
  // The revision in which the job ended by itself, until a checkpoint has tried to store it. The end is not
  // published before, since after a crash the job would run again.
  std::optional<std::uint64_t> unpublished_completion;
  // The determinism fingerprint of the workers that rendered it; empty before the first samples.
  std::string arithmetic;
  // The film while the job takes results. Null once the job is finished and stored: the store has it then.
  std::shared_ptr<film::JobFilm> film;
  // Whether it counts toward its submitter's unfinished jobs (State::set_open).
  bool is_open = false;
  // How many checks in a row found that the job lacks nothing but a worker to verify it.
  int checks_without_auditor = 0;
  // The counters of the film, if that is null.
  core::RenderCounters stored_counters;
};

// What describes a job at one moment. It is copied under the state lock; messages and rows are made of it
// without the lock.
struct JobSnapshot {
  JobSnapshot(const JobRecord& record, scheduler::JobView view, std::vector<std::string> troubles = {});

  std::shared_ptr<const v1::Job> spec;
  std::string request_id;
  std::uint64_t revision = 0;
  std::optional<std::int64_t> finished_ms;
  bool is_unpublished = false;
  std::string arithmetic;
  std::shared_ptr<const film::JobFilm> film;
  core::RenderCounters stored_counters;
  scheduler::JobView view;
  std::vector<std::string> troubles;
};

// The tiles of the job's window.
core::TileGrid grid_of(const v1::Job& spec);
scheduler::JobShape shape_of(const v1::Job& spec, std::uint32_t spp);

// The job as its users see it. A job whose completion is unpublished is shown as running.
v1::Job describe(const JobSnapshot& job);
// The same without the bundle, which can name thousands of files.
v1::Job summarise(const JobSnapshot& job);

// Whether the bytes are UTF-8, as texts of the protocol must be. A row of the store may hold anything.
bool is_text(const std::string& bytes);
store::JobRow to_row(const JobSnapshot& job);
// DATA_LOSS if the row cannot be read. The film is not filled in.
core::Result<JobRecord> from_row(const store::JobRow& row);

inline bool is_finished(scheduler::JobState state) {
  return state != scheduler::JobState::kRunning && state != scheduler::JobState::kPaused;
}

}  // namespace tessera::farm
