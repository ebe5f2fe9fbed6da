// SPDX-License-Identifier: Apache-2.0
// One job: what the coordinator keeps of it besides the scheduler's state. Plain data; guarded by the
// coordinator's state mutex.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>

#include "server/coordinator/blob_claims.hpp"
#include "server/coordinator/job_film.hpp"
#include "server/scheduler/scheduler.hpp"
#include "server/store/job_store.hpp"
#include "tessera/v1/types.pb.h"

namespace tessera::coordinator {

struct JobRecord {
  // The job as submitted: id, name, submitter, settings, bundle, display, priority, max_workers and
  // created_at. Never changes.
  std::shared_ptr<const v1::Job> spec;
  std::string request_id;
  BlobClaims::Hold files;  // the files of the bundle

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
  std::unique_ptr<JobFilm> film;
  // How many checks in a row found that the job lacks nothing but a worker to verify it.
  int checks_without_auditor = 0;
  // The counters of the film when it is not in memory.
  core::RenderCounters stored_counters;

  const core::RenderCounters& counters() const { return film ? film->counters() : stored_counters; }
};

// The tiles of the job's window.
core::TileGrid grid_of(const v1::Job& spec);
scheduler::JobShape shape_of(const v1::Job& spec, std::uint32_t spp);

// The job as its users see it. A job whose completion is unpublished is shown as running.
v1::Job describe(const JobRecord& record, const scheduler::JobView& view);
// The same without the bundle, which can name thousands of files.
v1::Job summarise(const JobRecord& record, const scheduler::JobView& view);

// Whether the bytes are UTF-8, as texts of the protocol must be. A row of the store may hold anything.
bool is_text(const std::string& bytes);
store::JobRow to_row(const JobRecord& record, const scheduler::JobView& view);
// DATA_LOSS if the row cannot be read. The film is not filled in.
core::Result<JobRecord> from_row(const store::JobRow& row);

inline bool is_finished(scheduler::JobState state) {
  return state != scheduler::JobState::kRunning && state != scheduler::JobState::kPaused;
}

}  // namespace tessera::coordinator
