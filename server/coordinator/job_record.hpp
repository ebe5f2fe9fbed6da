// SPDX-License-Identifier: Apache-2.0
// One job: what the scheduler does not know of it. Plain data; the coordinator's gate guards it.
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
  // As it was submitted: id, name, submitter, settings, bundle, display, priority, max_workers and
  // created_at. Never changes.
  std::shared_ptr<const v1::Job> spec;
  std::string request_id;
  BlobClaims::Hold files;  // the bundle's

  // Grows with every change of what the store keeps of the job besides its tiles.
  std::uint64_t revision = 1;
  std::uint64_t stored_revision = 0;
  std::optional<std::int64_t> finished_ms;
  // The revision in which it came to its end by itself, until a checkpoint has tried to store that: before, a
  // crash would make it run again, so nobody is told.
  std::optional<std::uint64_t> unpublished_completion;
  // Fingerprint of the workers that rendered it; empty before the first samples.
  std::string arithmetic;
  // While it takes results. Null once it is finished and stored: the store has it then.
  std::unique_ptr<JobFilm> film;
  // How often in a row it was seen to lack nothing but somebody to verify it.
  int checks_without_auditor = 0;
  // Of the film when there is none in memory.
  core::RenderCounters stored_counters;

  const core::RenderCounters& counters() const { return film ? film->counters() : stored_counters; }
};

// The tiles of what is rendered.
core::TileGrid grid_of(const v1::Job& spec);
scheduler::JobShape shape_of(const v1::Job& spec, std::uint32_t spp);

// The job as its users see it: one whose end is untold still runs.
v1::Job describe(const JobRecord& record, const scheduler::JobView& view);
// The same without the bundle, which can name thousands of files.
v1::Job summarise(const JobRecord& record, const scheduler::JobView& view);

// Whether a row's text can be told to anybody: the contract's texts are UTF-8.
bool is_text(const std::string& bytes);
store::JobRow to_row(const JobRecord& record, const scheduler::JobView& view);
// DATA_LOSS if the row cannot be read. The film is left out.
core::Result<JobRecord> from_row(const store::JobRow& row);

inline bool is_finished(scheduler::JobState state) {
  return state != scheduler::JobState::kRunning && state != scheduler::JobState::kPaused;
}

}  // namespace tessera::coordinator
