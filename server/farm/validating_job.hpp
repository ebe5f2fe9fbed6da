// SPDX-License-Identifier: Apache-2.0
// A job whose scene waits to be validated, or is being validated. The scheduler does not know it yet. Plain
// data; guarded by the state lock. And jobs as their rows in the store have them, in any state.
#pragma once

#include <cstdint>
#include <memory>
#include <stop_token>
#include <string>

#include "server/blobs/blob_claims.hpp"
#include "server/events/revision.hpp"
#include "server/farm/job_record.hpp"
#include "server/scheduler/types.hpp"
#include "server/store/job_store.hpp"
#include "tessera/v1/render_service.pb.h"

namespace tessera::farm {

struct ValidatingJob {
  // The job as submitted. Its settings are those of the overrides alone. Never changes.
  std::shared_ptr<const v1::Job> spec;
  // What was submitted and is no part of the job: overrides and display. Never changes.
  std::shared_ptr<const v1::SubmitJobRequest> submission;
  std::string request_id{};
  blobs::BlobClaims::Hold files{};  // the files of the bundle
  events::Revision revision = 0;    // of its row in the store
  events::Revision last_event = 0;  // its last change
  std::stop_source stop{};          // ends the validation
  // Somebody will validate it, or is doing so.
  bool is_queued = false;
  bool is_begun = false;
  // A validation that ended without a result is repeated, and not earlier than this; and why it did, for
  // users.
  scheduler::Time next_attempt{};
  std::string trouble{};
};

JobSnapshot snapshot_of(const ValidatingJob& job);

store::JobRow to_row(const ValidatingJob& job);
// DATA_LOSS if the row cannot be read. The files are not held.
core::Result<ValidatingJob> validating_from_row(const store::JobRow& row);

// ---- Rows of jobs in any state ----
// DATA_LOSS if the row cannot be read.
core::Result<std::shared_ptr<const v1::Job>> spec_from_row(const store::JobRow& row);
// A job as its row has it; if that cannot be read, snapshot_of_damaged().
JobSnapshot snapshot_of_row(const store::JobRow& row);

}  // namespace tessera::farm
