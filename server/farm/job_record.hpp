// SPDX-License-Identifier: Apache-2.0
// One job: what the coordinator keeps of it besides the scheduler's state. Plain data; guarded by the
// state lock.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "server/blobs/blob_claims.hpp"
#include "server/events/revision.hpp"
#include "server/farm/job_life.hpp"
#include "server/film/job_film.hpp"
#include "server/scheduler/scheduler.hpp"
#include "server/store/job_store.hpp"
#include "tessera/v1/types.pb.h"

namespace tessera::farm {

struct JobRecord {
  // The job as submitted and validated: id, name, owner, settings, bundle, display, priority, max_workers,
  // labels, warnings, images and created_at. Never changes.
  std::shared_ptr<const v1::Job> spec;
  // False for a job that was cancelled, or that failed, before its scene was validated: it has no image.
  bool is_validated = true;
  std::string request_id;
  blobs::BlobClaims::Hold files;  // the files of the bundle

  // The last change of what the store keeps of the job besides its tiles, and that of its row in the store.
  events::Revision revision = 0, stored_revision = 0;
  // The last change of any kind.
  events::Revision last_event = 0;
  std::optional<std::int64_t> finished_ms;
  // The revision in which the job ended by itself, until a checkpoint has tried to store it. The end is not
  // published before, since after a crash the job would run again.
  std::optional<events::Revision> unpublished_completion;
  // The determinism fingerprint of the workers that rendered it; empty before the first samples.
  std::string arithmetic;
  // Null if the job could not be recovered, or was never validated.
  std::shared_ptr<film::JobFilm> film;
  // The job could not be recovered, and its row in the store stays as it is. Other finished jobs leave the
  // memory once they are stored.
  bool row_is_left = false;
  // Whether it counts toward its owner's unfinished jobs (State::set_open).
  bool is_open = false;
  // The counters of the film, if that is null, and the samples of its images if there are several.
  core::RenderCounters stored_counters;
  std::vector<std::uint64_t> stored_samples_by_image;
  JobLife life{};
};

// What describes a job at one moment. It is copied under the state lock; messages and rows are made of it
// without the lock.
struct JobSnapshot {
  JobSnapshot(const JobRecord& record, scheduler::JobView view, std::vector<std::string> troubles = {});

  std::shared_ptr<const v1::Job> spec;
  bool is_validating = false;
  // The scenes that are validated before its own; absent if that is not known, or has begun.
  std::optional<std::size_t> scenes_ahead{};
  bool is_validated = true;
  std::string request_id;
  events::Revision revision = 0, last_event = 0;
  std::optional<std::int64_t> finished_ms;
  bool is_unpublished = false;
  std::string arithmetic;
  std::shared_ptr<const film::JobFilm> film;
  core::RenderCounters stored_counters;
  std::vector<std::uint64_t> stored_samples_by_image;
  JobLife life;
  scheduler::JobView view;
  std::vector<std::string> troubles;
};

// The layers of the job's images.
core::LayerSet layers_of(const v1::Job& spec);
// The tiles of the job's images.
scheduler::JobGrid grid_of(const v1::Job& spec);
scheduler::JobShape shape_of(const v1::Job& spec, std::uint32_t spp);
// That of a validated job whose row could be read.
scheduler::JobShape shape_of(const v1::Job& spec, const store::JobRow& row);

// What is known of a job from its spec alone: without the bundle, which can name thousands of files, without
// warnings and without the list of images.
v1::Job summarise_spec(const v1::Job& spec);
// The job as its users see it. A job whose completion is unpublished is shown as running.
v1::Job describe(const JobSnapshot& job);
// The same without the bundle, which can name thousands of files.
v1::Job describe_without_bundle(const JobSnapshot& job);
// The same without the bundle, without warnings, and without the lists of images and events.
v1::Job summarise(const JobSnapshot& job);

// Whether the job is done, and each pixel has as many samples as the settings say: no fewer, and no more.
bool has_all_samples(const JobSnapshot& job);

// Whether the bytes are UTF-8, as texts of the protocol must be. A row of the store may hold anything.
bool is_text(const std::string& bytes);
// A row that is not settled.
store::JobRow to_row(const JobSnapshot& job);
// DATA_LOSS if the row cannot be read. The film is not filled in. Not for jobs that are being validated
// (validating_job.hpp).
core::Result<JobRecord> from_row(const store::JobRow& row);
core::Error damaged_job(const std::string& id);
// What never changes of a job, in the columns of its row. Reading returns false if it cannot be read; the
// bundle is left out where the row was read without it.
void write_spec(const v1::Job& spec, store::JobRow& row);
bool read_spec(const store::JobRow& row, v1::Job& spec);
// A job that cannot be recovered for this reason, shown as failed. Its files are known if the row can be
// read.
JobRecord record_of_damaged(const store::JobRow& row);
JobSnapshot snapshot_of_damaged(const store::JobRow& row, const core::Error& error);

// The shape that a job has for the scheduler if its scene was never validated.
inline const scheduler::JobShape kNoShape{1, 1, 1};

inline bool is_finished(scheduler::JobState state) {
  return state != scheduler::JobState::kRunning && state != scheduler::JobState::kPaused;
}

}  // namespace tessera::farm
