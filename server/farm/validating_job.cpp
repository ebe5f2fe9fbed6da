// SPDX-License-Identifier: Apache-2.0
#include "server/farm/validating_job.hpp"

#include <utility>

#include "server/farm/stored_job.hpp"
#include "server/farm/wire.hpp"

namespace tessera::farm {

JobSnapshot snapshot_of(const ValidatingJob& job) {
  JobRecord record;
  record.spec = job.spec;
  record.is_validated = false;
  record.request_id = job.request_id;
  record.revision = job.revision;
  record.last_event = job.last_event;
  scheduler::JobView view;
  view.id = {job.spec->id()};
  view.shape = kNoShape;
  JobSnapshot snapshot(record, std::move(view));
  snapshot.is_validating = true;
  if (!job.trouble.empty()) snapshot.troubles = {job.trouble};
  return snapshot;
}

store::JobRow to_row(const ValidatingJob& job) {
  store::JobRow row;
  write_spec(*job.spec, row);
  row.request_id = job.request_id;
  row.revision = job.revision;
  row.state = v1::JOB_STATE_VALIDATING;
  row.priority = job.spec->priority();
  row.max_workers = job.spec->max_workers();
  row.submission = encode_submission(*job.submission);
  return row;
}

core::Result<ValidatingJob> validating_from_row(const store::JobRow& row) {
  auto spec = std::make_shared<v1::Job>();
  auto submission = std::make_shared<v1::SubmitJobRequest>();
  if (!row.intact || !read_spec(row, *spec) || !decode_submission(row.submission, *submission))
    return core::fail(damaged_job(row.id));
  ValidatingJob job{.spec = std::move(spec), .submission = std::move(submission)};
  job.request_id = row.request_id;
  job.revision = job.last_event = row.revision;
  return job;
}

core::Result<std::shared_ptr<const v1::Job>> spec_from_row(const store::JobRow& row) {
  if (row.state == v1::JOB_STATE_VALIDATING) {
    const auto validating = validating_from_row(row);
    if (!validating) return core::fail(validating.error());
    return validating->spec;
  }
  const auto record = from_row(row);
  if (!record) return core::fail(record.error());
  return record->spec;
}

JobSnapshot snapshot_of_row(const store::JobRow& row) {
  if (row.state == v1::JOB_STATE_VALIDATING) {
    const auto validating = validating_from_row(row);
    return validating ? snapshot_of(*validating) : snapshot_of_damaged(row, validating.error());
  }
  const auto record = from_row(row);
  if (!record) return snapshot_of_damaged(row, record.error());
  scheduler::JobView view;
  view.id = {row.id};
  view.shape = record->is_validated ? shape_of(*record->spec, row) : kNoShape;
  view.state = from_wire(static_cast<v1::JobState>(row.state));
  view.failure = row.failure;
  view.failure_details = decode_failure(row.failure_details);
  view.priority = row.priority;
  view.max_workers = row.max_workers;
  view.samples_done = record->stored_counters.samples;
  view.samples_total = record->is_validated ? view.shape.pixel_samples() : 0;
  return {*record, std::move(view)};
}

}  // namespace tessera::farm
